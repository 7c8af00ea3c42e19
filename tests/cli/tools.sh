# What the tests of common behaviour know about each tool; to be sourced in a scratch folder.
#
# A new tool needs a function tool_NAME (with _ for -) that calls, as far as they apply:
#   command ARGS...      a short run that succeeds; @OUT@ stands for the file it writes, and the
#                        first word that starts with good. for an image it reads
#   output EXT           the ending that @OUT@ takes
#   slow ARGS...         a run of several seconds that writes @OUT@ (tools that read no image)
#   big ARGS...          a run that needs more than 1 GB (tools whose options can ask for that)

make_inputs() {
    cp "$SRC/examples/scenes/cornell_point.gltf" good.gltf
    cp "$SRC/examples/scenes/cornell_spot.gltf" good.spot.gltf
    ls-inject good.gltf --photons 500 --voxels 4x4x4 -o good.cache.exr
    "$SRC/tests/cli/make_image" good.exr 16x16 R='x/w' G='y/h' B='noise()'
    "$SRC/tests/cli/make_image" reference.exr 16x16 R='x/w' G='y/h' B='0.5'
}

tool_img_diff() {
    command --heatmap @OUT@ good.exr reference.exr
    output exr
}

tool_img_spectrum() {
    command --mask --picture @OUT@ good.exr
    output exr
}

tool_bn_render() {
    command --size 16x16 -o @OUT@ good.gltf
    output exr
    slow --size 512x512 --spp 4096 -o @OUT@ good.gltf
    big --size 12000x12000 -o @OUT@ good.gltf
}

tool_bn_mask() {
    command --size 16x16 -o @OUT@
    output exr
    slow --size 3000x3000 -o @OUT@
}

tool_bn_anneal() {
    command good.exr --channel B --radius 2 -o @OUT@
    output exr
}

tool_bn_permute() {
    command --image good.exr --mask reference.exr --channel R -o @OUT@
    output exr
}

tool_rsm_render() {
    command good.spot.gltf --size 16x16 --rsm-size 32 --samples 4 -o @OUT@
    output exr
    slow good.spot.gltf --size 512x512 --rsm-size 64 --samples 4096 -o @OUT@
    big good.spot.gltf --size 16x16 --rsm-size 8192 --max-memory 100 -o @OUT@
}

tool_ls_inject() {
    command --photons 500 --voxels 4x4x4 -o @OUT@ good.gltf
    output exr
    slow --photons 1e9 --voxels 4x4x4 -o @OUT@ good.gltf
    big --photons 10 --voxels 600x600x600 -o @OUT@ good.gltf
}

tool_ls_merge() {
    command good.cache.exr -o @OUT@
    output exr
}

tool_ls_sample() {
    command --cache good.cache.exr --size 8x8 -o @OUT@ "$SRC/examples/scenes/cornell_point.gltf"
    output exr
    big --cache good.cache.exr --size 12000x12000 -o @OUT@ "$SRC/examples/scenes/cornell_point.gltf"
}

# load TOOL: sets ARGS (an array), EXT, SLOW, BIG, INPUT (the word in ARGS that is read, or nothing).
load() {
    ARGS=() SLOW=() BIG=() EXT='' INPUT=''
    command() { ARGS=("$@"); }
    output() { EXT=$1; }
    slow() { SLOW=("$@"); }
    big() { BIG=("$@"); }
    local name=tool_${1//-/_}
    if ! declare -F "$name" >/dev/null; then
        echo "$1: tests/cli/tools.sh has no line for this tool"
        return 1
    fi
    "$name"
    unset -f command big
    local word
    for word in "${ARGS[@]}"; do
        case $word in good.*) INPUT=$word; break ;; esac
    done
}

# all_tools: the names of the tools in the folder that comes first on PATH.
all_tools() {
    local bin=${PATH%%:*} file
    for file in "$bin"/*; do [ -f "$file" ] && [ -x "$file" ] && basename "$file"; done
}

# arguments OUT [INPUT]: ARGS with @OUT@ and the input replaced, into RUN.
arguments() {
    local word
    RUN=()
    for word in "${ARGS[@]}"; do
        [ "$word" = @OUT@ ] && word=$1
        [ -n "${2-}" ] && [ "$word" = "$INPUT" ] && word=$2
        RUN+=("$word")
    done
}

# expect TOOL WHAT STATUS COMMAND...: complains unless the command ends with that status.
expect() {
    local tool=$1 what=$2 wanted=$3 status
    shift 3
    "$@" >out.txt 2>err.txt
    status=$?
    [ $status = "$wanted" ] || { echo "$tool: $what: exit status $status, expected $wanted"; sed 's/^/    /' err.txt; }
}

# one_line TOOL WHAT: complains unless err.txt is one line that begins with the tool's name.
one_line() {
    [ "$(wc -l <err.txt)" = 1 ] && [[ $(cat err.txt) == "$1: "* ]] ||
        { echo "$1: $2: expected one line on standard error"; sed 's/^/    /' err.txt; }
}

# nothing TOOL WHAT FILE: complains if there is anything.
nothing() { [ ! -s "$3" ] || { echo "$1: $2: $3 is not empty"; sed 's/^/    /' "$3"; }; }

# no_files TOOL WHAT PREFIX: complains if a file or temporary file of that name is there.
no_files() {
    local left
    left=$(find . -maxdepth 1 \( -name "$3*" -o -name ".$3*" \))
    [ -z "$left" ] || { echo "$1: $2: left behind $left"; rm -f $left; }
}
