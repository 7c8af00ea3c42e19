. "$SRC/tests/cli/tools.sh"
# What a machine can refuse: room on the disk, a folder, a file that was there a moment ago.
[ "$OMP_NUM_THREADS" = 2 ] || exit 0 # once is enough
make_inputs
for tool in $(all_tools); do
    load "$tool" || continue

    # A file system without room: the file that is there stays as it is
    if [ -n "$EXT" ]; then
        mkdir -p small
        if mount -t tmpfs -o size=4k none small 2>/dev/null; then
            echo before >small/result.$EXT
            cp small/result.$EXT kept
            arguments small/result.$EXT
            expect "$tool" "full disk" 4 "$tool" "${RUN[@]}"
            one_line "$tool" "full disk"
            cmp kept small/result.$EXT || echo "$tool: full disk: the old file is gone"
            [ -z "$(find small -name '.*' -type f)" ] || echo "$tool: full disk: left $(ls -A small)"
            umount small
        fi
        # A limit of the size of files, which is a signal unless the tool sees to it
        arguments result.$EXT
        (ulimit -f 0 && exec "$tool" "${RUN[@]}") 2>&1 >/dev/null | cat >err.txt
        [ "${PIPESTATUS[0]}" = 4 ] || echo "$tool: ulimit -f 0: wrong status"
        one_line "$tool" "ulimit -f 0"
        no_files "$tool" "ulimit -f 0" result
        # A folder where nothing can be made: /proc takes no files, not even from root
        arguments /proc/result.$EXT
        expect "$tool" "read-only folder" 4 "$tool" "${RUN[@]}"
        one_line "$tool" "read-only folder"
        # A folder under the very name of the result
        mkdir result.$EXT
        arguments result.$EXT
        expect "$tool" "a folder of that name" 4 "$tool" "${RUN[@]}"
        one_line "$tool" "a folder of that name"
        rmdir result.$EXT
        no_files "$tool" "a folder of that name" .result
        # A folder that goes while the tool is at work
        if [ -n "$INPUT" ]; then
            mkdir gone
            mkfifo pipe.exr
            arguments gone/result.$EXT pipe.exr
            timeout 60 bash -c 'exec 3>pipe.exr && rmdir gone && cat "$0" >&3' "$INPUT" &
            expect "$tool" "folder gone" 4 "$tool" "${RUN[@]}"
            one_line "$tool" "folder gone"
            wait
            rm -f pipe.exr
        fi
    fi

    # An input that ends in the middle, as when its writer dies
    if [ -n "$INPUT" ]; then
        mkfifo pipe.exr
        arguments result.$EXT pipe.exr
        timeout 60 bash -c 'head -c 700 "$0" >pipe.exr' "$INPUT" &
        expect "$tool" "input cut short" 3 "$tool" "${RUN[@]}"
        one_line "$tool" "input cut short"
        wait
        rm -f pipe.exr
        no_files "$tool" "input cut short" result
    fi
    rm -f result*
done

# Of several frames those before the fault are whole, and what comes after is not there
bn-render --size 8x8 good.gltf --frames 0-1 -o 'f.%04d.exr' --seeds-out 's.%04d.exr'
bn-render --size 8x8 good.gltf --frames 0-2 -o 'g.%04d.exr' --seeds 's.%04d.exr' 2>err.txt
[ $? = 3 ] || echo "a seed texture that is gone: wrong status"
one_line bn-render "a seed texture that is gone"
cmp f.0001.exr g.0001.exr
[ ! -e g.0002.exr ] || echo "a frame without its seeds"

# A reader that goes away ends the tool without a word, or with one line
bn-mask --size 1024x1024 --method white --format exr -o - 2>err.txt | head -c 100 >/dev/null
status=${PIPESTATUS[0]}
[ "$status" = 141 ] || [ "$status" = 4 ] || echo "a pipe without reader: status $status"
