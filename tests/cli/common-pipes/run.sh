. "$SRC/tests/cli/tools.sh"
make_inputs
for tool in $(all_tools); do
    load "$tool" || continue
    arguments result.$EXT
    "$tool" "${RUN[@]}" >out.txt || echo "$tool: failed"

    # An image from a pipe is like the same image from a file
    if [ -n "$INPUT" ]; then
        arguments piped.$EXT -
        cat $INPUT | "$tool" "${RUN[@]}" >piped.txt || echo "$tool: from a pipe: failed"
        cmp out.txt piped.txt
        [ -z "$EXT" ] || cmp result.$EXT piped.$EXT || echo "$tool: from a pipe: another result"
        : | "$tool" "${RUN[@]}" >piped.txt 2>err.txt
        [ $? = 3 ] || echo "$tool: an empty pipe: wrong status"
        one_line "$tool" "an empty pipe"
    fi

    # A result on standard output is like the same result in a file
    if [ -n "$EXT" ] && "$tool" --help | grep -q -- "--format"; then
        arguments -
        "$tool" "${RUN[@]}" --format $EXT | cat >piped.$EXT
        cmp result.$EXT piped.$EXT || echo "$tool: standard output: another result"
        "$tool" "${RUN[@]}" >piped.txt 2>err.txt
        [ $? = 2 ] || echo "$tool: standard output without --format: wrong status"
        one_line "$tool" "standard output without --format"
    fi
    rm -f result* piped*
done
