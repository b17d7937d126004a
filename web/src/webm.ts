// A WebM file (RFC 8794, RFC 9559) of one VP8 track, as long as it fits into memory.

/** Elements in the order of the file, by their names in RFC 9559. */
const ids = {
  EBML: [0x1a, 0x45, 0xdf, 0xa3], DocType: [0x42, 0x82], DocTypeVersion: [0x42, 0x87], DocTypeReadVersion: [0x42, 0x85],
  Segment: [0x18, 0x53, 0x80, 0x67], Info: [0x15, 0x49, 0xa9, 0x66], TimestampScale: [0x2a, 0xd7, 0xb1], Duration: [0x44, 0x89],
  MuxingApp: [0x4d, 0x80], WritingApp: [0x57, 0x41],
  Tracks: [0x16, 0x54, 0xae, 0x6b], TrackEntry: [0xae], TrackNumber: [0xd7], TrackUID: [0x73, 0xc5], TrackType: [0x83], FlagLacing: [0x9c],
  CodecID: [0x86], Video: [0xe0], PixelWidth: [0xb0], PixelHeight: [0xba],
  Cues: [0x1c, 0x53, 0xbb, 0x6b], CuePoint: [0xbb], CueTime: [0xb3], CueTrackPositions: [0xb7], CueTrack: [0xf7], CueClusterPosition: [0xf1],
  Cluster: [0x1f, 0x43, 0xb6, 0x75], Timestamp: [0xe7], SimpleBlock: [0xa3],
};

function joined(parts: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

/** Sizes and numbers take four bytes, so that no position depends on a value. */
function element(name: keyof typeof ids, content: number | string | readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const head = (bytes: number) => Uint8Array.of(...ids[name], 0x10 | (bytes >>> 24), bytes >>> 16, bytes >>> 8, bytes);
  const value =
    typeof content === "number" ? Uint8Array.of(content >>> 24, content >>> 16, content >>> 8, content)
    : typeof content === "string" ? new TextEncoder().encode(content)
    : joined(content);
  return joined([head(value.length), value]);
}

function float(name: keyof typeof ids, value: number): Uint8Array {
  const bytes = new DataView(new ArrayBuffer(8));
  bytes.setFloat64(0, value);
  return element(name, [new Uint8Array(bytes.buffer)]);
}

/** A picture at its time after the start of its cluster, in milliseconds. */
function block(chunk: EncodedVideoChunk): Uint8Array {
  const data = new Uint8Array(4 + chunk.byteLength);
  const [key_frame, ms] = [0x80, Math.round(chunk.timestamp / 1000)];
  data.set([0x81, ms >> 8, ms, chunk.type === "key" ? key_frame : 0]);
  chunk.copyTo(data.subarray(4));
  return element("SimpleBlock", [data]);
}

/**
 * Pictures that play several times. Each turn is one cluster: the first picture must be a key frame, and none of them
 * comes later than 32 s.
 */
export function webm(pictures: readonly EncodedVideoChunk[], { width, height, turns, turn_ms }: { width: number; height: number; turns: number; turn_ms: number }): Uint8Array<ArrayBuffer> {
  const head = element("EBML", [element("DocType", "webm"), element("DocTypeVersion", 2), element("DocTypeReadVersion", 2)]);
  const info = element("Info", [element("TimestampScale", 1_000_000), float("Duration", turns * turn_ms), element("MuxingApp", "Dynasurf"), element("WritingApp", "Dynasurf")]);
  const video = element("Video", [element("PixelWidth", width), element("PixelHeight", height)]);
  const track = element("TrackEntry", [element("TrackNumber", 1), element("TrackUID", 1), element("TrackType", 1), element("FlagLacing", 0), element("CodecID", "V_VP8"), video]);
  const before = [info, element("Tracks", [track])];
  const start = (turn: number) => Math.round(turn * turn_ms);
  const blocks = pictures.map(block);
  const clusters = Array.from({ length: turns }, (_, turn) => element("Cluster", [element("Timestamp", start(turn)), ...blocks]));
  const cues = (first: number) =>
    element("Cues", clusters.map((cluster, turn) =>
      element("CuePoint", [element("CueTime", start(turn)), element("CueTrackPositions", [element("CueTrack", 1), element("CueClusterPosition", first + turn * cluster.length)])])));
  const first = joined(before).length + cues(0).length;
  return joined([head, element("Segment", [...before, cues(first), ...clusters])]);
}
