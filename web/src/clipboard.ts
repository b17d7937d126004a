/** Puts words on the clipboard. Its own interface is for pages from the network; a file has this one. */
export function copyText(words: string, beside: HTMLElement): void {
  const area = document.createElement("textarea");
  area.value = words;
  beside.append(area);
  area.select();
  document.execCommand("copy");
  area.remove();
}
