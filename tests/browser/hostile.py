"""Gives the channels of a recording names that want to be markup: hostile.py RUN.toml RUN.csv NEW.toml NEW.csv."""
import csv
import json
import sys

NAMES = [
    "<img src=x onerror=alert(1)>",
    '"><script>alert(2)</script>',
    "</script><script>alert(3)</script>",
    "&amp;&lt;b&gt;",
    "<svg/onload=alert(4)>",
    "' onmouseover='alert(5)",
    "</style></title></textarea><!--",
    "javascript:alert(6)",
]

if __name__ == "__main__":
    old_toml, old_csv, new_toml, new_csv = sys.argv[1:]
    rows = list(csv.reader(open(old_csv, newline="")))
    channels = [name for name in rows[0] if name != "t"]
    renamed = dict(zip(channels, NAMES, strict=True))
    rows[0] = [renamed.get(name, name) for name in rows[0]]
    csv.writer(open(new_csv, "w", newline="")).writerows(rows)
    text = open(old_toml).read().replace(f'"{old_csv}"', f'"{new_csv}"')
    for old, new in renamed.items():
        # a JSON string is a TOML string
        text = text.replace(f'"{old}"', json.dumps(new))
    open(new_toml, "w").write(text)
