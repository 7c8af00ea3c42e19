. "$SRC/tests/cli/tools.sh"
make_inputs
cp good.exr good.whole
: >empty.exr
head -c 300 good.whole >truncated.exr
head -c 2000 good.whole >short.exr
echo "this is text" >text.exr
mkdir folder.exr
for tool in $(all_tools); do
    load "$tool" || continue
    [ -n "$INPUT" ] || continue
    for bad in missing empty truncated short text folder; do
        arguments result.$EXT $bad.exr
        expect "$tool" $bad 3 "$tool" "${RUN[@]}"
        one_line "$tool" $bad
        grep -q "$bad.exr" err.txt || echo "$tool: $bad: the message does not name the file"
        nothing "$tool" $bad out.txt
        no_files "$tool" $bad result
    done
done
