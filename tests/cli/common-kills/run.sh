. "$SRC/tests/cli/tools.sh"
# Signals at moments drawn by lot over a whole run: the old file stays or the new one is whole, and
# no temporary file is left, but after SIGKILL. QL_KILLS: how often each tool is stopped.
[ "$OMP_NUM_THREADS" = 2 ] || exit 0 # once is enough
make_inputs
kills=${QL_KILLS:-5}
RANDOM=7

for tool in $(all_tools); do
    load "$tool" || continue
    [ -n "$EXT" ] || continue
    echo "the old file" >old.$EXT
    ended=0 old=0 new=0
    for ((i = 0; i < kills; ++i)); do
        # How long does a run take, as busy as the machine is now?
        if [ $((i % 20)) = 0 ]; then
            arguments whole.$EXT
            begin=$(date +%s%N)
            "$tool" "${RUN[@]}" >/dev/null 2>err.txt || echo "$tool: $(cat err.txt)"
            length_us=$((($(date +%s%N) - begin) / 1000))
            arguments result.$EXT
        fi
        cp old.$EXT result.$EXT
        signal=$(set -- INT TERM KILL HUP && shift $((i % 4)) && echo $1)
        # Half of them anywhere, half near the end, where files are written
        moment=$((RANDOM * 32768 + RANDOM))
        if [ $((i / 4 % 2)) = 0 ]; then
            moment=$((moment % (length_us * 3 / 2)))
        else
            moment=$((length_us * 3 / 4 + moment % (length_us * 3 / 4)))
        fi
        env --default-signal=INT,TERM,HUP "$tool" "${RUN[@]}" >out.txt 2>err.txt &
        pid=$!
        sleep "$(printf '%d.%06d' $((moment / 1000000)) $((moment % 1000000)))"
        kill -$signal $pid 2>/dev/null
        wait $pid 2>/dev/null
        status=$?
        what="SIG$signal after $moment us"
        if [ $status = 0 ]; then
            ended=$((ended + 1))
        elif [ $((status - 128)) != "$(kill -l $signal)" ]; then
            echo "$tool: $what: status $status: $(cat err.txt)"
        fi
        nothing "$tool" "$what" err.txt
        if cmp -s result.$EXT old.$EXT; then
            old=$((old + 1))
            [ $status != 0 ] || echo "$tool: $what: ended well without a result"
        elif cmp -s result.$EXT whole.$EXT; then
            new=$((new + 1))
        else
            echo "$tool: $what: a file that is neither the old nor the new one"
        fi
        left=$(find . -maxdepth 1 -name ".result.$EXT.*")
        [ -z "$left" ] || [ $signal = KILL ] || echo "$tool: $what: left $left"
        rm -f .result.*
    done
    [ -z "${QL_KILLS-}" ] || echo "$tool: $kills signals in ${length_us} us: $old old, $new new, $ended ended before" >>"${QL_KILLS_LOG:-/dev/null}"
    rm -f result.* whole.* old.*
done 2> >(grep -v -E 'Terminated|Killed|Hangup|Interrupt' >&2)
