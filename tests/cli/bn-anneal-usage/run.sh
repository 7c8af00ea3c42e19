# Wrong calls and wrong masks: one line each, and no file.
bn-mask --size 8x8 -o mask.png
bn-mask --size 8x8 --channels 3 -o three.png
refused() {
    local wanted=$1
    shift
    bn-anneal "$@" -o out.exr
    [ $? -eq "$wanted" ] || echo "wrong status: $*"
}
refused 2 mask.png --seed 1
refused 2 mask.png --solver anneal --schedule linear --alpha 0.9
refused 2 mask.png --solver anneal --schedule hajek --equilibrium 9
refused 2 mask.png --solver anneal --alpha 1.5
refused 2 mask.png --solver anneal --snapshot 100
refused 2 mask.png --step 1,1 --offsets r2
refused 2 mask.png --motion 1,1 --motions 1
refused 2 mask.png --step 1.5,1
refused 2 mask.png --motion 119,0
refused 2 mask.png --solver anneal --motions 1 --trace t.csv
refused 3 three.png
refused 3 three.png --channel Z
refused 3 missing.png
ls
