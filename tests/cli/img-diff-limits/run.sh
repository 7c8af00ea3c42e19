# Every limit holds on one side and fails on the other
"$SRC/tests/cli/make_image" a.exr 16x16 Y=1.5
"$SRC/tests/cli/make_image" b.exr 16x16 Y=1
try() { img-diff "$@" a.exr b.exr >/dev/null; echo "$? $*"; }
try --max-mse 0.25
try --max-mse 0.2499
try --max-rmse 0.5
try --max-rmse 0.4999
try --max-relmse 0.2476
try --max-relmse 0.2475
try --max-block-relmse 0.2476
try --max-block-relmse 0.2475
try --max-abs 0.5
try --max-abs 0.4999
try --max-perceptual 0.2501
try --max-perceptual 0.2499 --sigma 1 --sigma 3
try --min-psnr 6
try --min-psnr 6.1
try --mean-ratio 1.4,1.5
try --mean-ratio 1.51,2
try --mean-ratio 0.9,1.1
try --max-mse 0.1 --quiet
try --max-mse nan
try --mean-ratio 1
try --sigma -1
try --identical --max-mse 1
