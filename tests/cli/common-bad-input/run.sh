. "$SRC/tests/cli/tools.sh"
make_inputs
cp good.exr good.whole
: >empty.exr
head -c 300 good.whole >truncated.exr
head -c 2000 good.whole >short.exr
echo "this is text" >text.exr
mkdir folder.exr
"$SRC/tests/cli/make_image" good.png 16x16 R='x' G='y' B='255*noise()'
head -c 200 good.png >cut_png.exr
python3 -c "b = bytearray(open('good.png', 'rb').read()); b[80] ^= 1; open('flipped_png.exr', 'wb').write(b)"
for tool in $(all_tools); do
    load "$tool" || continue
    [ -n "$INPUT" ] || continue
    for bad in missing empty truncated short text folder cut_png flipped_png; do
        arguments result.$EXT $bad.exr
        expect "$tool" $bad 3 "$tool" "${RUN[@]}"
        one_line "$tool" $bad
        grep -q "$bad.exr" err.txt || echo "$tool: $bad: the message does not name the file"
        nothing "$tool" $bad out.txt
        no_files "$tool" $bad result
    done
done
