# The exact solver meets its bound, annealing stays above it, and both formats say what they hold.
set -eu
figure() { python3 -c 'import json, sys; r = json.load(open(sys.argv[1]))["result"]; print(*(r[k] for k in sys.argv[2:]))' "$@"; }
bn-mask --size 32x32 --seed 3 -o mask.png
bn-anneal mask.png -o exact.exr --stats exact.json
figure exact.json bijection step
[ "$(figure exact.json energy energy_bound)" = "$(figure exact.json energy energy).0" ] || echo "not at the bound"
bn-anneal mask.png --solver anneal --steps 1000000 --trace trace.csv --snapshot every=400000 \
    -o annealed.png --stats annealed.json
[ "$(figure annealed.json energy_bound)" = "$(figure exact.json energy_bound)" ] || echo "two bounds"
python3 - <<'END'
import csv, json
exact, annealed = (json.load(open(n + ".json"))["result"] for n in ("exact", "annealed"))
assert exact["energy"] < annealed["energy"] < 0.5 * exact["energy_initial"], (exact, annealed)
rows = list(csv.DictReader(open("trace.csv")))
assert int(rows[-1]["step"]) == 1000000 and int(rows[-1]["energy"]) == annealed["energy"]
temperatures = [float(row["temperature"]) for row in rows]
assert temperatures == sorted(temperatures, reverse=True) and len(rows) > 900
END
grep -aq ql:energy_bound annealed.png && grep -aq ql:energy_bound exact.exr || echo "no metadata"
bn-anneal mask.png --motions 1 --radius 2 -o set.exr --stats set.json
python3 -c 'import json; r = json.load(open("set.json"))["result"]; print(len(r["textures"]), r["bijection"])'
bn-anneal mask.png --offsets r2 --radius 2 -o r2.png
ls
