. "$SRC/tests/cli/tools.sh"
# Signals at moments drawn by lot over a whole run: the old file stays or the new one is whole, and
# no temporary file is left, but after SIGKILL. QL_KILLS: how often each tool is hit while it runs;
# QL_KILLS_LOG: a file for the counts.
[ "$OMP_NUM_THREADS" = 2 ] || exit 0 # once is enough
make_inputs
kills=${QL_KILLS:-5}
RANDOM=7

for tool in $(all_tools); do
    load "$tool" || continue
    [ -n "$EXT" ] || continue
    echo "the old file" >old.$EXT
    # How long does a run take, as busy as the machine is now?
    arguments whole.$EXT
    begin=$(date +%s%N)
    "$tool" "${RUN[@]}" >/dev/null 2>err.txt || echo "$tool: $(cat err.txt)"
    length_us=$((($(date +%s%N) - begin) / 1000))
    arguments result.$EXT
    hit=0 old=0 new=0
    for ((i = 0; hit < kills && i < 20 * kills; ++i)); do
        cp old.$EXT result.$EXT
        signal=$(set -- INT TERM KILL HUP && shift $((i % 4)) && echo $1)
        # Half of them anywhere, half near the end, where files are written
        moment=$((RANDOM * 32768 + RANDOM))
        if [ $((i / 4 % 2)) = 0 ]; then
            moment=$((moment % length_us))
        else
            moment=$((length_us * 3 / 4 + moment % (length_us / 4)))
        fi
        env --default-signal=INT,TERM,HUP "$tool" "${RUN[@]}" >out.txt 2>err.txt &
        pid=$!
        sleep "$(printf '%d.%06d' $((moment / 1000000)) $((moment % 1000000)))"
        kill -$signal $pid 2>/dev/null
        wait $pid 2>/dev/null
        status=$?
        what="SIG$signal after $moment us"
        nothing "$tool" "$what" err.txt
        if cmp -s result.$EXT old.$EXT; then
            found=old
        elif cmp -s result.$EXT whole.$EXT; then
            found=new
        else
            found=neither
            echo "$tool: $what: a file that is neither the old nor the new one"
        fi
        left=$(find . -maxdepth 1 -name ".result.$EXT.*")
        [ -z "$left" ] || [ $signal = KILL ] || echo "$tool: $what: left $left"
        rm -f .result.*
        # A signal that came too late does not count, and the next come earlier
        if [ $status = 0 ]; then
            [ $found = new ] || echo "$tool: $what: ended well without a result"
            length_us=$((length_us * 15 / 16 + 8))
            continue
        fi
        [ $((status - 128)) = "$(kill -l $signal)" ] || echo "$tool: $what: status $status: $(cat err.txt)"
        hit=$((hit + 1)) length_us=$((length_us * 17 / 16))
        case $found in old) old=$((old + 1)) ;; new) new=$((new + 1)) ;; esac
    done
    [ $hit = $kills ] || echo "$tool: only $hit of $i signals came while it ran"
    echo "$tool: $i signals, $hit while it ran: $old old, $new new" >>"${QL_KILLS_LOG:-/dev/null}"
    rm -f result.* whole.* old.*
done 2> >(grep -v -E 'Terminated|Killed|Hangup|Interrupt' >&2)
