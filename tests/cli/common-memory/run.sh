. "$SRC/tests/cli/tools.sh"
# Little memory (ulimit -v): a tool works, or says so in one line. Below what the libraries need to
# start, main() is not reached; there the loader or a library speaks.
make_inputs
step=32768 # KiB
[ "$OMP_NUM_THREADS" = 2 ] || exit 0 # once is enough

# succeeds LIMIT COMMAND...
succeeds() { (ulimit -v "$1" && shift && "$@" >out.txt 2>err.txt) 2>/dev/null; }

# least LOW HIGH COMMAND...: the least limit at which the command succeeds
least() {
    local low=$1 high=$2 middle
    shift 2
    while [ $((high - low)) -gt $step ]; do
        middle=$(((low + high) / 2))
        if succeeds $middle "$@"; then high=$middle; else low=$middle; fi
    done
    echo $high
}

# AddressSanitizer takes addresses by the terabyte: no limit says anything of such a build.
succeeds $((1 << 30)) bn-mask --version || exit 0

for tool in $(all_tools); do
    load "$tool" || continue
    arguments result.$EXT
    starts=$(least 300000 1500000 "$tool" --version)
    works=$(least $starts 1500000 "$tool" "${RUN[@]}")
    for part in 1 2 3; do
        limit=$((starts + step + (works - starts) * part / 3))
        rm -f result.$EXT
        succeeds $limit "$tool" "${RUN[@]}"
        status=$?
        [ $status = 0 ] || [ $status = 4 ] || echo "$tool: $limit KiB: status $status: $(cat err.txt)"
        [ $status = 0 ] || one_line "$tool" "$limit KiB"
        [ $status = 0 ] || no_files "$tool" "$limit KiB" result
    done
    # A picture that no limit of 1 GB holds
    if [ ${#BIG[@]} -gt 0 ]; then
        ARGS=("${BIG[@]}")
        rm -f result.$EXT
        arguments result.$EXT
        succeeds 1000000 "$tool" "${RUN[@]}"
        [ $? = 4 ] || echo "$tool: big: expected status 4: $(cat err.txt)"
        one_line "$tool" big
        grep -q "out of memory" err.txt || echo "$tool: big: $(cat err.txt)"
        no_files "$tool" big result
    fi
done
