. "$SRC/tests/cli/tools.sh"
make_inputs
for tool in $(all_tools); do
    load "$tool" || continue
    for run in "-j1" "-j2" "-j1 again"; do
        arguments result.$EXT
        "$tool" "${RUN[@]}" ${run% again} >"out $run" 2>&1 || echo "$tool $run: $(cat "out $run")"
        [ -z "$EXT" ] || mv result.$EXT "result $run"
    done
    for run in "-j2" "-j1 again"; do
        cmp "out -j1" "out $run"
        [ -z "$EXT" ] || cmp "result -j1" "result $run" || echo "$tool: -j1 and $run differ"
    done
    # The date in headers is that of the environment, or a fixed one
    if [ -n "$EXT" ]; then
        arguments result.$EXT
        SOURCE_DATE_EPOCH=1000000000 "$tool" "${RUN[@]}" >/dev/null
        grep -qa "2001:09:09 01:46:40" result.$EXT || echo "$tool: SOURCE_DATE_EPOCH is not in the file"
        SOURCE_DATE_EPOCH=yesterday "$tool" "${RUN[@]}" >/dev/null 2>err.txt
        [ $? = 2 ] || echo "$tool: a wrong SOURCE_DATE_EPOCH: wrong status"
    fi
    rm -f result* out*
done
