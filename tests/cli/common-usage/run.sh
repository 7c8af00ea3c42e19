. "$SRC/tests/cli/tools.sh"
make_inputs
for tool in $(all_tools); do
    load "$tool" || continue

    expect "$tool" --help 0 "$tool" --help
    grep -q "^Example:" out.txt || echo "$tool: --help: no example"
    nothing "$tool" --help err.txt

    expect "$tool" --version 0 "$tool" --version
    grep -qE "^$tool [0-9.]+ \(git ([0-9a-f]+|unknown)\)$" out.txt || echo "$tool: --version: $(cat out.txt)"
    expect "$tool" "--version -v" 0 "$tool" --version -v
    grep -q OpenEXR out.txt || echo "$tool: --version -v: no libraries"

    arguments result.$EXT
    expect "$tool" "unknown flag" 2 "$tool" "${RUN[@]}" --no-such-flag
    one_line "$tool" "unknown flag"
    grep -q "try $tool --help" err.txt || echo "$tool: unknown flag: does not point to --help"
    nothing "$tool" "unknown flag" out.txt
    no_files "$tool" "unknown flag" result
    expect "$tool" "threads" 2 "$tool" "${RUN[@]}" --threads many
    one_line "$tool" "threads"
    expect "$tool" "progress" 2 "$tool" "${RUN[@]}" --progress sometimes
    one_line "$tool" "progress"
    expect "$tool" "missing config" 3 "$tool" "${RUN[@]}" --config missing.toml
    one_line "$tool" "missing config"
    printf 'no-such-option = 1\n' >options.toml
    expect "$tool" "unknown option in a file" 2 "$tool" "${RUN[@]}" --config options.toml
    one_line "$tool" "unknown option in a file"
    grep -q no-such-option err.txt || echo "$tool: does not name the unknown option in a file"
    no_files "$tool" "unknown option in a file" result
    printf 'threads =\n' >options.toml
    expect "$tool" "empty value in a file" 2 "$tool" "${RUN[@]}" --config options.toml
    one_line "$tool" "empty value in a file"
    expect "$tool" "empty value" 2 "$tool" "${RUN[@]}" --stats ""
    one_line "$tool" "empty value"
    no_files "$tool" "empty value" result

    # A run that succeeds says nothing on standard error, and writes the stats it is asked for
    expect "$tool" run 0 "$tool" "${RUN[@]}" --stats stats.json
    nothing "$tool" run err.txt
    [ -z "$EXT" ] || [ -s result.$EXT ] || echo "$tool: run: no result"
    python3 "$SRC/tests/cli/check_stats" "$tool" stats.json
    rm -f result* stats.json

    # Names of files are bytes, not text
    arguments result-$'\xf4\xff'.$EXT
    expect "$tool" "name that is no UTF-8" 0 "$tool" "${RUN[@]}" --stats stats.json
    python3 "$SRC/tests/cli/check_stats" "$tool" stats.json
    rm -f result* stats.json
    arguments result.$EXT

    # The same options from a file
    expect "$tool" "progress on request" 0 "$tool" "${RUN[@]}" --progress always --quiet
    nothing "$tool" "quiet" err.txt
    printf 'threads = 1\n' >options.toml
    expect "$tool" "config" 0 "$tool" "${RUN[@]}" --config options.toml --stats stats.json
    grep -q '"threads": 1' stats.json || echo "$tool: config: threads were not taken"
    rm -f result* stats.json options.toml
done
