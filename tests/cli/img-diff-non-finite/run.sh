# A single sample that is not finite fails, with and without limits, in either image
make="$SRC/tests/cli/make_image"
"$make" good.exr 16x16 Y=1
"$make" nan.exr 16x16 'Y=nan if (x, y) == (3, 5) else 1'
"$make" inf.exr 16x16 'Y=inf if (x, y) == (3, 5) else 1'
"$make" all.exr 16x16 Y=nan
for pair in "nan good" "good nan" "inf good" "inf inf" "nan nan" "all good"; do
    set -- $pair
    img-diff --max-mse 1e9 --max-relmse 1e9 $1.exr $2.exr 2>err.txt | grep -E '^(mse|non_finite)' | tr '\n' ' '
    img-diff --quiet $1.exr $2.exr >/dev/null
    echo "$? $pair"
done
cat err.txt
img-diff --identical nan.exr nan.exr
echo $?
img-diff --heatmap heat.exr nan.exr good.exr >/dev/null 2>&1
img-diff --json heat.exr heat.exr --channels G | grep mean_image
