. "$SRC/tests/cli/tools.sh"
# The tool is stopped while it waits for a pipe or works on a slow run.
make_inputs
for tool in $(all_tools); do
    load "$tool" || continue
    for signal in INT TERM HUP; do
        if [ -n "$INPUT" ]; then
            mkfifo pipe.exr
            arguments result.$EXT pipe.exr
        elif [ ${#SLOW[@]} -gt 0 ]; then
            ARGS=("${SLOW[@]}")
            arguments result.$EXT
        else
            echo "$tool: neither reads an image nor has a slow run"
            continue
        fi
        env --default-signal=INT,TERM,HUP "$tool" "${RUN[@]}" >out.txt 2>err.txt &
        pid=$!
        sleep 0.3
        kill -$signal $pid || echo "$tool: ended before SIG$signal: $(cat err.txt)"
        wait $pid 2>/dev/null
        status=$?
        [ $((status - 128)) = "$(kill -l $signal)" ] || echo "$tool: SIG$signal: status $status"
        nothing "$tool" SIG$signal err.txt
        no_files "$tool" SIG$signal result
        rm -f pipe.exr
    done
done
