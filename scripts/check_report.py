#!/usr/bin/env python3
"""Opens reports in headless Chromium as a reader would: narrow, wide, and printed.

    python3 scripts/check_report.py REPORT.html [REPORT.html ...]

Fails if the console has a message, if anything is asked of a network, if the page is wider than its window, if a
figure is empty, or if a text in a figure is cut or lies on another. Standard library only; CHROMIUM names the
browser where it is not on the PATH.
"""

import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

WIDTHS = (400, 1600)
SECONDS = 120
# Two labels may touch: boxes of text hold room above and below the letters. As shares of the smaller box.
OVERLAP = 0.15

PROBE = """
<script>
window.addEventListener("load", () => {
  const box = (element) => element.getBoundingClientRect();
  const problems = [];
  const root = document.documentElement;
  if (root.scrollWidth > window.innerWidth) {
    const wide = [...document.body.querySelectorAll("*")].find((e) => box(e).right > window.innerWidth + 1);
    problems.push(`the page is ${root.scrollWidth} wide, its window ${window.innerWidth}: `
      + (wide ? wide.outerHTML.slice(0, 120) : "no element found"));
  }
  const asked = performance.getEntriesByType("resource").map((entry) => entry.name);
  asked.filter((name) => !name.startsWith("data:")).forEach((name) => problems.push(`asks for ${name}`));
  const figures = [...document.querySelectorAll("svg")];
  figures.forEach((figure, number) => {
    const frame = box(figure);
    const named = `figure ${number + 1} (${((figure.querySelector("text") || {}).textContent || "").trim()})`;
    if (!(frame.width > 100 && frame.height > 50)) problems.push(`${named} is empty`);
    const texts = [...figure.querySelectorAll("text")].map((t) => [t.textContent.trim(), box(t)]);
    if (texts.length < 4) problems.push(`${named} has no labels`);
    for (const [i, [text, a]] of texts.entries()) {
      if (a.left < frame.left - 1 || a.right > frame.right + 1 || a.top < frame.top - 1 || a.bottom > frame.bottom + 1)
        problems.push(`${named}: \\u201c${text}\\u201d is cut`);
      for (const [other, b] of texts.slice(i + 1)) {
        const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const up = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        const share = OVERLAP * Math.min(a.height, b.height, a.width, b.width);
        if (across > share && up > share) problems.push(`${named}: \\u201c${text}\\u201d lies on \\u201c${other}\\u201d`);
      }
    }
  });
  const sections = [...document.querySelectorAll("section")].length;
  const found = { width: window.innerWidth, figures: figures.length, sections, problems };
  parent.postMessage(JSON.stringify(found), "*");
});
</script>
""".replace("OVERLAP", str(OVERLAP))


# Windows of Chromium are 500 wide at least; frames may be narrower.
FRAME = """<!doctype html><body style="margin: 0"><pre id="probe"></pre><script>
addEventListener("message", (message) => { document.getElementById("probe").textContent = message.data; });
</script><iframe src="PAGE" style="width: WIDTHpx; height: 1000px; border: 0"></iframe></body>"""


def browser():
    names = [os.environ.get("CHROMIUM", ""), "chromium", "chromium-browser", "google-chrome"]
    found = next((path for path in map(shutil.which, filter(None, names)) if path), None)
    return found or sys.exit("check_report: no Chromium; sh scripts/setup --browser installs it")


def run(page, profile, *options):
    # Chromium has no sandbox for root and in most containers; the page is ours.
    command = [browser(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
    command += ["--enable-logging=stderr", "--log-level=0", "--host-resolver-rules=MAP * ~NOTFOUND"]
    command += [f"--user-data-dir={profile}", *options, page.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=True)


def at_width(report, folder, width):
    """What the probe finds at a width of the window."""
    probed = folder / f"{width}.html"
    text = report.read_text(encoding="utf-8")
    probed.write_text(text.replace("</body>", PROBE + "</body>"), encoding="utf-8")
    framed = folder / f"frame_{width}.html"
    frame = FRAME.replace("PAGE", probed.name).replace("WIDTH", str(width))
    framed.write_text(frame, encoding="utf-8")
    options = ["--window-size=1800,1100", "--virtual-time-budget=5000", "--dump-dom"]
    done = run(framed, folder / "profile", *options)
    found = re.search(r'<pre id="probe">(.+?)</pre>', done.stdout, re.S)
    if not found:
        return [f"{width} px: the page was not shown: {done.stderr[-500:]}"], None
    probe = json.loads(html.unescape(found.group(1)))
    problems = list(probe["problems"])
    problems += [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
    if probe["width"] != width:
        problems.append(f"the frame is {probe['width']} px wide")
    return [f"{width} px: {problem}" for problem in problems], probe


def printed(report, folder):
    """Whether it can be printed."""
    paper = folder / "printed.pdf"
    run(report, folder / "profile", f"--print-to-pdf={paper}")
    pages = len(re.findall(rb"/Type\s*/Page\b", paper.read_bytes())) if paper.exists() else 0
    return pages, [] if pages else ["the print has no pages"]


def check(report):
    problems = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for width in WIDTHS:
            found, probe = at_width(report, folder, width)
            problems += found
        pages, found = printed(report, folder)
        problems += found
    if probe and (probe["figures"] == 0 or probe["sections"] == 0):
        problems.append("no figures or no sections")
    for problem in problems:
        print(f"{report}: {problem}")
    if not problems:
        print(f"{report}: {probe['sections']} sections, {probe['figures']} figures, {pages} pages on paper")
    return not problems


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    results = [check(pathlib.Path(argument).resolve()) for argument in arguments]
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main(sys.argv[1:])
