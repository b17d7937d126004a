// Frames that show pages which the program wrote.

/** Loads a page into a new frame in the old one's place: Chromium may leave a frame blank that changes after it was hidden. */
export function load(frame: HTMLIFrameElement, url: string): HTMLIFrameElement {
  const next = frame.cloneNode() as HTMLIFrameElement;
  next.src = url;
  frame.replaceWith(next);
  return next;
}
