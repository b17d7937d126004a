// Whether a page speaks German: what its reader meets, held against the sentences of the translation.
import { readFileSync } from "node:fs";

export const german = JSON.parse(readFileSync(new URL("../src/translations/de.json", import.meta.url), "utf8"));

/** A report as the page shows it that speaks German. */
export const inGerman = (report) =>
  report
    .replace('<html lang="en">', '<html lang="de">')
    .replace('<script type="application/json" id="data">', (data) => {
      const json = JSON.stringify(german).replaceAll("<", "\\u003c");
      return `<script type="application/json" id="words">${json}</script>${data}`;
    });

/** All texts of a page, and those that are told or spoken. */
export const saidIn = (frame) =>
  frame.evaluate(() => {
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode())
      if (node.nodeType === Node.TEXT_NODE) {
        if (!/^(script|style|noscript)$/i.test(node.parentElement.tagName)) found.push(node.nodeValue.trim());
      } else for (const name of ["title", "aria-label", "placeholder", "alt"]) found.push((node.getAttribute(name) ?? "").trim());
    return [...new Set(found.filter(Boolean))];
  });

const places = /{\w+}/;
const plain = (text) => text.replace(/[\\^$.*+?()[\]{}|/-]/g, "\\$&");
const patternOf = (text) => new RegExp(`^${text.split(places).map(plain).join(".+?")}$`);
const pairs = [...Object.entries(german.pages), ...Object.entries(german.program)];
const english = pairs
  .filter(([sentence, text]) => sentence !== text && /[a-z]{3}/i.test(sentence.split(places).join("")))
  .map(([sentence]) => patternOf(sentence));
const own = pairs.filter(([, text]) => /[a-z]{3}/i.test(text.split(places).join(""))).map(([, text]) => patternOf(text));
const english_word = /\b(the|of|and|is|are|with|from|this|that|by|slice|gates?|surfaces?|wall|volumes?|cavity|border)\b/i;

/** Texts that are a sentence in English, or hold a word that no German one has. */
export const notGerman = (said) =>
  said
    .map((text) => text.replace(/^[\w.]+ · /, "")) // a note's code
    .filter((text) => english_word.test(text) || (english.some((p) => p.test(text)) && !own.some((p) => p.test(text))));
