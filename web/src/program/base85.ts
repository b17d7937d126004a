// Bytes as text that may stand in a page: four bytes are five of 85 signs, a fifth more instead of the third more of
// base64. The signs are those from "#" to "w", with "x" and "y" in the place of "<" and "&", which pages read.
export function textOf(bytes: Uint8Array): string {
  const text: string[] = [];
  for (let n = 0; n < bytes.length; n += 4) {
    let word = 0;
    for (let b = 0; b < 4; ++b) word = word * 256 + (bytes[n + b] ?? 0);
    const signs: string[] = [];
    for (let k = 0; k < 5; ++k, word = Math.floor(word / 85)) signs.unshift(String.fromCharCode((word % 85) + 35));
    text.push(signs.join(""));
  }
  return `${bytes.length} ${text.join("").replaceAll("<", "x").replaceAll("&", "y")}`;
}

export function bytesOf(text: string): Uint8Array<ArrayBuffer> {
  const space = text.indexOf(" ");
  const bytes = new Uint8Array(Number(text.slice(0, space)));
  for (let n = 0, at = space + 1; n < bytes.length; n += 4) {
    let word = 0;
    for (let k = 0; k < 5; ++k, ++at) {
      const sign = text.charCodeAt(at);
      word = word * 85 + (sign === 120 ? 60 : sign === 121 ? 38 : sign) - 35;
    }
    for (let b = 3; b >= 0; --b, word = Math.floor(word / 256)) bytes[n + b] = word % 256; // beyond the end: nothing
  }
  return bytes;
}
