. "$SRC/tests/cli/tools.sh"
# The tool is stopped while it waits for a pipe or works on a slow run.
make_inputs
for tool in $(all_tools); do
    load "$tool" || continue
    [ -n "$INPUT" ] || [ ${#SLOW[@]} -gt 0 ] || echo "$tool: neither reads an image nor has a slow run"
    for signal in INT TERM HUP; do
        for way in pipe slow; do
            if [ $way = pipe ]; then
                [ -n "$INPUT" ] || continue
                mkfifo pipe.exr
                arguments result.$EXT pipe.exr
            else
                [ ${#SLOW[@]} -gt 0 ] || continue
                short=("${ARGS[@]}") ARGS=("${SLOW[@]}")
                arguments result.$EXT
                ARGS=("${short[@]}")
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
done
