. "$SRC/tests/cli/tools.sh"
make_inputs
for tool in $(all_tools); do
    load "$tool" || continue

    # A full disk: standard output of tools that print, the file of tools that write one
    if [ -n "$EXT" ]; then
        ln -sf /dev/full full.$EXT
        arguments full.$EXT
        expect "$tool" "/dev/full" 4 "$tool" "${RUN[@]}"
        one_line "$tool" "/dev/full"
        arguments missing-folder/result.$EXT
        expect "$tool" "missing folder" 4 "$tool" "${RUN[@]}"
        one_line "$tool" "missing folder"
    fi
    arguments result.$EXT
    "$tool" "${RUN[@]}" >out.txt 2>err.txt
    if [ -s out.txt ]; then
        "$tool" "${RUN[@]}" >/dev/full 2>err.txt
        [ $? = 4 ] || echo "$tool: stdout to /dev/full: wrong status"
        one_line "$tool" "stdout to /dev/full"
    fi
    expect "$tool" "stats to /dev/full" 4 "$tool" "${RUN[@]}" --stats /dev/full
    one_line "$tool" "stats to /dev/full"
    "$tool" --help >/dev/full 2>err.txt
    [ $? = 4 ] || echo "$tool: --help to /dev/full: wrong status"

    # A message that nobody can read is no other error
    "$tool" --no-such-option 2>/dev/full
    [ $? = 2 ] || echo "$tool: stderr to /dev/full: wrong status"
    "$tool" --no-such-option 2>&-
    [ $? = 2 ] || echo "$tool: closed stderr: wrong status"

    # Where a name is a link, the file it leads to is written
    if [ -n "$EXT" ]; then
        mkdir -p linked
        ln -sf linked/target.$EXT full.$EXT
        arguments full.$EXT
        "$tool" "${RUN[@]}" >/dev/null 2>err.txt
        [ -L full.$EXT ] && [ -s linked/target.$EXT ] || echo "$tool: a link was replaced: $(cat err.txt)"
        rm -rf linked
        arguments result.$EXT
    fi

    # With standard output closed, files are still written and not mixed up with it
    if [ -n "$EXT" ] && [ ! -s out.txt ]; then
        mv result.$EXT before.$EXT
        "$tool" "${RUN[@]}" >&- 2>err.txt || echo "$tool: closed stdout: $(cat err.txt)"
        cmp before.$EXT result.$EXT || echo "$tool: closed stdout: another result"
    fi
    rm -f result* full* before*
done
