"""Computes the figures of results.csv again, from ratings.csv, with Python; prints both and ends with status 1 where they differ.
Needs numpy and scipy; pingouin and krippendorff where they are installed.   python3 analysis.py [FOLDER]"""
import csv, pathlib, sys
import numpy as np
from scipy import stats
folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
ratings = [r for r in csv.DictReader(open(folder / "ratings.csv", encoding="utf-8")) if r["excluded"] == "0"]
if any(r.get("simulated") == "1" for r in ratings):
    print("SIMULATED ANSWERS: no person took part.")
ours = {(r["scenario"], r["dimension"], r["statistic"], r["which"]): float(r["value"]) for r in csv.DictReader(open(folder / "results.csv", encoding="utf-8"))}
planners = (folder / "planners.txt").read_text(encoding="utf-8").split("\n")
compared = far = 0
def check(key, value, by=1e-6):
    global compared, far
    if key not in ours:
        return
    compared += 1
    bad = not np.isfinite(value) or abs(value - ours[key]) > by * max(1, abs(value))
    far += bad
    print("%-12s %-22s %-20s %-16s %14.8f %14.8f %s" % (*key, ours[key], value, "DIFFERS" if bad else ""))
print("%-12s %-22s %-20s %-16s %14s %14s" % ("scenario", "dimension", "statistic", "which", "SocRATES", "Python"))
for scenario, dimension in dict.fromkeys((s, d) for s, d, _, _ in ours):
    part = [r for r in ratings if r["scenario"] == scenario and r["dimension"] == dimension]
    items = sorted({r["item"] for r in part})
    blocks = {}
    for r in part:
        # An empty cell is missing, never 0.
        blocks.setdefault((r["participant"], r["planner"], r["film"]), {})[r["item"]] = float(r["score"]) if r["score"] else np.nan
    rows = np.array([[b.get(i, np.nan) for i in items] for b in blocks.values()])
    whole = rows[~np.isnan(rows).any(axis=1)]
    if len(items) > 1:
        k = len(items)
        check((scenario, dimension, "alpha", ""), k / (k - 1) * (1 - whole.var(axis=0, ddof=1).sum() / whole.sum(axis=1).var(ddof=1)))
    scores, films = {}, {}
    for (who, planner, film), row in zip(blocks, rows):
        given = (~np.isnan(row)).sum()
        if given and 2 * given >= len(items):
            scores.setdefault((who, planner), []).append(np.nanmean(row))
            films.setdefault(film, {})[who] = np.nanmean(row)
    shown = [p for p in planners if any(q == p for _, q in scores)]
    people = [w for w in dict.fromkeys(w for w, _ in scores) if all((w, p) in scores for p in shown)]
    table = np.array([[np.mean(scores[w, p]) for p in shown] for w in people])
    if len(shown) > 2:
        chi2, p = stats.friedmanchisquare(*table.T.round(9))
        check((scenario, dimension, "friedman_chi2", ""), chi2)
        check((scenario, dimension, "friedman_p", ""), p)
    for j in range(len(shown)):
        for i in range(j):
            d = (table[:, j] - table[:, i]).round(9)
            kept = d[d != 0]
            exact = len(kept) <= 25 and len(kept) == len(d) and len(set(abs(d))) == len(d)
            for name, zero in (("pratt", "pratt"), ("dropped", "wilcox")):
                test = stats.wilcoxon(d, zero_method=zero, correction=False, method="exact" if exact else "asymptotic")
                check((scenario, dimension, "wilcoxon_p_" + name, f"{shown[j]} - {shown[i]}"), test.pvalue)
    try:
        import krippendorff
        names = sorted({w for f in films.values() for w in f})
        data = np.array([[films[f].get(w, np.nan) for f in films] for w in names])
        check((scenario, dimension, "krippendorff_ordinal", ""), krippendorff.alpha(data.round(9), level_of_measurement="ordinal"))
    except ImportError:
        print("krippendorff is not installed: its figure is not compared")
print(compared, "figures compared,", far, "differ")
sys.exit(1 if far or not compared else 0)
