// Texts in the reader's language. A text is written where it stands, in English, and a translation is a table from
// these sentences: one file of translations/. A report that stands alone has no table and speaks English; a page that
// shows it writes one into it, in the element `words`.

export interface Translation {
  /** The language's own name. */
  name: string;
  /** What stands before the decimals of a number. */
  decimal: string;
  /** What the pages say. */
  pages: Record<string, string>;
  /**
   * What the program says in its results and refusals: a {place} stands for any value, {sentence} for one that has an
   * entry, {file}, {path}, {name} and {word} for what is called so in every language.
   */
  program: Record<string, string>;
  /** What options are, and their units. */
  options: Record<string, string>;
}
export type Values = Record<string, string | number>;

const places = /{(\w+)}/g;
const kept = new Set(["file", "path", "name", "word"]);
const attributes = ["title", "aria-label", "placeholder", "alt"] as const;

const filled = (text: string, values: Values): string => text.replace(places, (place, name: string) => String(values[name] ?? place));

interface Pattern {
  /** Fixed texts and between them the names of places. */
  parts: string[];
  text: string;
  fixed: number;
}

function patternOf([sentence, text]: [string, string]): Pattern {
  const parts = sentence.split(places);
  return { parts, text, fixed: parts.filter((_, n) => n % 2 === 0).join("").length };
}

export class Words {
  private known: Pattern[] | null = null;
  private readonly found = new Map<string, string | null>();

  constructor(private readonly table: Translation | null) {}

  /** A text of a page with its {places} filled. */
  say(english: string, values: Values = {}): string {
    return filled(this.table?.pages[english] ?? english, values);
  }

  /** A number with so many decimals. */
  number(value: number, decimals: number): string {
    return this.decimals(value.toFixed(decimals));
  }

  /** A number as the program wrote it; other words as they are. */
  private decimals(word: string): string {
    return /^[-+]?\d+\.\d+$/.test(word) ? word.replace(".", this.table?.decimal ?? ".") : word;
  }

  /** A sentence that the program wrote; English where the table has none like it. */
  told(sentence: string): string {
    return this.find(sentence) ?? sentence;
  }

  /** The description of an option or its unit. */
  described(english: string): string {
    return this.table?.options[english] ?? english;
  }

  /** First what begins with fixed text, then what is said of a file; of each what has most fixed text: the others are made for what is left. */
  private get patterns(): Pattern[] {
    if (this.known) return this.known;
    const sentences = Object.entries(this.table?.program ?? {}).filter(([sentence]) => sentence.includes("{"));
    const begins_late = ({ parts }: Pattern) => (parts[0] !== "" ? 0 : parts[1] === "file" ? 1 : 2);
    return (this.known = sentences.map(patternOf).sort((a, b) => begins_late(a) - begins_late(b) || b.fixed - a.fixed));
  }

  private find(sentence: string): string | null {
    const before = this.found.get(sentence);
    if (before !== undefined) return before;
    let text = this.table?.program[sentence] ?? null;
    for (let n = 0; text === null && n < this.patterns.length; ++n) text = this.fill(this.patterns[n]!, sentence);
    this.found.set(sentence, text);
    return text;
  }

  /** The text of a pattern that fits a sentence; null: it does not. */
  private fill({ parts, text }: Pattern, sentence: string): string | null {
    const values = sentence.startsWith(parts[0]!) ? this.valuesOf(parts, 1, sentence.slice(parts[0]!.length)) : null;
    return values && filled(text, values);
  }

  /** Values of the places from `n` on in what is left of a sentence, each as short as it can be. */
  private valuesOf(parts: string[], n: number, left: string): Values | null {
    const [name, next] = [parts[n]!, parts[n + 1]!];
    const is_last = n + 2 === parts.length;
    for (let at = 1; at <= left.length; ++at) {
      if (is_last ? left.slice(at) !== next : !left.startsWith(next, at)) continue;
      const told = kept.has(name) ? null : this.find(left.slice(0, at));
      if (told === null && name.startsWith("sentence")) continue;
      const more = is_last ? {} : this.valuesOf(parts, n + 2, left.slice(at + next.length));
      if (more) return { [name]: told ?? this.decimals(left.slice(0, at)), ...more };
    }
    return null;
  }

  /** Puts all texts of a page into the language: those of its own, or with `told` those that the program wrote. */
  translate(page: Document, told = false): void {
    if (!this.table) return;
    const text = (english: string) => (told ? this.told(english) : this.say(english));
    const walker = page.createTreeWalker(page.documentElement, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
    for (let node: Node | null = walker.currentNode; node; node = walker.nextNode()) {
      if (node instanceof Element)
        for (const name of attributes) if (node.hasAttribute(name)) node.setAttribute(name, text(node.getAttribute(name)!));
      const own = node.nodeType === Node.TEXT_NODE && !/^(SCRIPT|STYLE|NOSCRIPT)$/i.test(node.parentElement!.tagName) ? node.nodeValue!.trim() : "";
      if (own) node.nodeValue = node.nodeValue!.replace(own, () => text(own));
    }
  }
}

function tableHere(): Translation | null {
  const text = document.getElementById("words")?.textContent;
  return text ? (JSON.parse(text) as Translation) : null;
}

/** The words of this page. */
export const words = new Words(tableHere());
export const say = (english: string, values: Values = {}): string => words.say(english, values);
export const told = (sentence: string): string => words.told(sentence);

/** How the walls are called in a line of text. */
export const wall_words = { endo: say("endo"), epi: say("epi") } as const;
