"""Copies of a good page with one fault each, and what must be said of them."""

import re


def faults(page):
    """(name, check of in_page.js, page, words of the complaint)"""
    nonce = re.search(r'<script nonce="(\w+)"', page).group(1)
    lawless = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page)
    end = lambda text, piece: text.replace("</main>", f"{piece}</main>", 1)
    script = lambda text: page.replace("</body>", f'<script nonce="{nonce}">{text}</script></body>', 1)
    style = lambda text: page.replace("</head>", f'<style nonce="{nonce}">{text}</style></head>', 1)
    edited = lambda old, new: page.replace(old, new, 1)
    far = "http://127.0.0.1:9/x.png"
    clear = "document.querySelectorAll('canvas').forEach((c) => { c.width = c.width; })"
    stop = "(e) => { if (e.target.closest('.u-legend')) e.stopPropagation(); }"
    made = [
        ("throws", "drawn", script('throw new Error("on purpose")'), "error: on purpose"),
        ("logs", "drawn", script('console.error("on purpose")'), "console: on purpose"),
        ("fetches", "drawn", end(lawless, f'<img src="{far}">'), f"request: {far}"),
        ("refused", "drawn", end(page, f'<img src="{far}">'), "Content Security Policy"),
        ("alerts", "drawn", end(lawless, "<svg onload=alert(4)></svg>"), "dialog: 4"),
        ("acts", "foreign", end(page, '<p onclick="alert(1)">x</p>'), "p with onclick"),
        ("foreign", "foreign", end(page, f'<img src="{far}">'), "an element img"),
        ("leads-away", "foreign", end(page, f'<a href="{far}">x</a>'), f'a with href="{far}"'),
        ("wide", "layout", end(page, '<svg width="900" height="9"><path d="M0 0H900V9"/></svg>'), "the page is "),
        ("pale", "layout", style("body { color: #aaa; }"), "contrast"),
        ("ragged", "layout", style(".plot .u-live .u-series:first-child { order: 0 !important; }"), "px aside"),
        ("undrawn", "drawn", edited("drawn.push({", "place.replaceChildren(); drawn.push({"), "was not drawn"),
        ("blank", "drawn", script(f"requestAnimationFrame(() => {clear})"), "is blank"),
        ("empty-drawing", "drawn", end(page, "<svg></svg>"), "is empty"),
        ("still", "motion", edited("    draw();\n    requestAnimationFrame(step);", ""), "does not move"),
        ("restless", "motion", edited("if (!playing || !seen)", "if (!seen)"), "does not pause"),
        ("dead-button", "controls", end(page, "<button>dead</button>"), '"dead" changes nothing'),
        ("leads-nowhere", "controls", end(page, '<a href="#nowhere">x</a>'), "leads nowhere"),
        ("dead-legend", "legends", script(f"addEventListener('click', {stop}, true)"), "nothing changes without"),
    ]
    for name, _, text, _ in made:
        assert text != page, f"the fault {name} finds no place in the page"
    return made
