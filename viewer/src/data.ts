// What the report page is given: the JSON that src/batten/report/html.cpp writes into #batten-data.

export interface SplineData {
  degree: number[];
  knots: number[][];
  shape: number[];
  dim: number;
  /** Control points relative to the centre, row-major, last axis fastest. */
  control: Float32Array;
}

export interface Frame {
  iteration: number;
  control: Float32Array;
}

export interface ReportData {
  title: string;
  brief: string;
  command: string;
  words: [string, string][];
  met: boolean | null;
  verdict: string;
  kind: string;
  unit: string;
  tolerance: number;
  maximum: number;
  rms: number;
  worst: number;
  count: number;
  dim: number;
  /** Whether the spline is a function's graph, drawn in other units along every axis. */
  graph: boolean;
  /** Coordinates are drawn relative to the centre, each times its stretch. */
  centre: number[];
  stretch: number[];
  /** Indices of the samples shown; all when null. */
  shown: Int32Array | null;
  samples: Float32Array;
  deviations: Float32Array;
  spline: SplineData;
  frames: Frame[];
  history: { iteration: number[]; gradient: number[]; deviation: number[] } | null;
}

function bytes(text: string): ArrayBuffer {
  const raw = atob(text);
  const result = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) result[i] = raw.charCodeAt(i);
  return result.buffer;
}

const floats = (text: string) => new Float32Array(bytes(text));

/** Reads the page's data; throws when the page was opened without any. */
export function readData(): ReportData {
  const element = document.getElementById("batten-data");
  const raw = JSON.parse(element?.textContent ?? "");
  return {
    ...raw,
    shown: raw.shown === null ? null : new Int32Array(bytes(raw.shown)),
    samples: floats(raw.samples),
    deviations: floats(raw.deviations),
    spline: { ...raw.spline, control: floats(raw.spline.control) },
    frames: raw.frames.map((f: { iteration: number; control: string }) => ({ iteration: f.iteration, control: floats(f.control) })),
  };
}
