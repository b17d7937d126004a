"""The page of `./dev thesis`: Markdown tables of the experiments and pictures become one HTML file."""

import base64
import html
import re

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 1080px; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.7em; } h2 { margin-top: 2.5em; border-bottom: 2px solid #0072b2; } h3 { margin-top: 2em; }
table { border-collapse: collapse; font-size: 13px; margin: 0.8em 0; display: block; overflow-x: auto; }
th, td { border: 1px solid #ccc; padding: 3px 8px; text-align: left; } th { background: #f0f4f7; }
td { font-variant-numeric: tabular-nums; }
.says { border-left: 4px solid #e69f00; padding: 0.2em 0.9em; background: #fdf8ec; }
figure { margin: 1.2em 0; } figure img { max-width: 100%; border: 1px solid #ddd; }
figcaption { font-size: 13px; color: #555; } code { background: #f4f4f4; padding: 0 3px; }
pre { background: #f7f7f7; padding: 0.8em; overflow-x: auto; font-size: 12.5px; }
nav a { margin-right: 0.8em; white-space: nowrap; }
"""


def sections(text):
    """Heading -> Markdown below it, of a text with `## headings`."""
    found = {}
    for part in re.split(r"(?m)^## ", text)[1:]:
        head, _, body = part.partition("\n")
        found[head.strip()] = body.strip()
    return found


def row_cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def table_html(lines):
    head, body = row_cells(lines[0]), [row_cells(line) for line in lines[2:]]
    out = ["<table><tr>" + "".join(f"<th>{html.escape(cell)}</th>" for cell in head) + "</tr>"]
    for cells in body:
        out.append("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>")
    return "\n".join(out) + "</table>"


def markdown_html(text):
    """Tables, and paragraphs of plain lines; `code` stays code. Text set in columns is kept as it stands."""
    out, lines = [], text.splitlines()
    while lines:
        line = lines.pop(0)
        if line.startswith("|") and lines and set(lines[0]) <= set("|- "):
            block = [line]
            while lines and lines[0].startswith("|"):
                block.append(lines.pop(0))
            out.append(table_html(block))
        elif line.startswith("  ") or re.search(r"\S {3,}\S", line):
            block = [line]
            while lines and lines[0].strip() and not lines[0].startswith("|"):
                block.append(lines.pop(0))
            out.append("<pre>" + html.escape("\n".join(block)) + "</pre>")
        elif line.strip():
            out.append("<p>" + re.sub(r"`([^`]*)`", r"<code>\1</code>", html.escape(line)) + "</p>")
    return "\n".join(out)


class Page:
    def __init__(self, stamp):
        self.stamp, self.parts, self.text, self.chapters = stamp, [], [stamp], []

    def chapter(self, title):
        anchor = re.sub(r"\W+", "-", title.lower())
        self.chapters.append((anchor, title))
        self.parts.append(f'<h2 id="{anchor}">{html.escape(title)}</h2>')
        self.text.append(f"\n{title}\n{'=' * len(title)}")

    def table(self, name, title, markdown, says):
        """A table of the thesis: `name` as in the list of published numbers, `says` where ours differ and why."""
        self.parts += [f"<h3>{html.escape(f'{name}: {title}')}</h3>", markdown_html(markdown),
                       f'<p class="says">{html.escape(says)}</p>']
        self.text.append(f"\n{name}: {title}\n\n{markdown}\n\n{says}")

    def figure(self, title, picture, command):
        """A PNG, moving or not, or an SVG, and how to make it."""
        data = base64.b64encode(picture.read_bytes()).decode()
        kind = "svg+xml" if picture.suffix == ".svg" else "png"
        self.text.append(f"\nFigure: {title}. {command}")
        self.parts.append(f'<figure><img alt="{html.escape(title)}" src="data:image/{kind};base64,{data}">'
                          f"<figcaption>{html.escape(title)}. <code>{html.escape(command)}</code></figcaption></figure>")

    def html(self):
        links = "".join(f'<a href="#{anchor}">{html.escape(title)}</a>' for anchor, title in self.chapters)
        return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>The thesis, measured again</title>'
                f"<style>{STYLE}</style></head><body><h1>The thesis, measured again</h1><p>{html.escape(self.stamp)}</p>"
                f"<nav>{links}</nav>" + "\n".join(self.parts) + "</body></html>\n")
