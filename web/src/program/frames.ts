// Frames that show pages which the program wrote.

/** Prints the page in a frame without the one around it, which would cut it off. */
export function printAlone(frame: HTMLIFrameElement, event: KeyboardEvent): void {
  if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "p") return;
  event.preventDefault();
  frame.contentWindow?.print();
}

/**
 * Loads a page into a new frame in the old one's place: Chromium may leave a frame blank that changes after it was hidden.
 * As the frame's own text, for a page of an address of its own could make no film: browsers take it for insecure.
 */
export function load(frame: HTMLIFrameElement, page: string): HTMLIFrameElement {
  const next = frame.cloneNode() as HTMLIFrameElement;
  next.srcdoc = page;
  next.addEventListener("load", () => {
    next.contentWindow?.addEventListener("dragover", (event) => {
      event.preventDefault();
      document.body.classList.add("over"); // from now on the frame lets what is dragged through to the page
    });
    next.contentWindow?.addEventListener("keydown", (event) => printAlone(next, event));
  });
  frame.replaceWith(next);
  return next;
}
