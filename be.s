{
  "kind": "curve",
  "samples": 240,
  "dim": 2,
  "degree": [
    3
  ],
  "control_shape": [
    10
  ],
  "closed": [
    true
  ],
  "method": "search",
  "method_reason": "knots where the error is, then as few as hold it",
  "settings": {},
  "iterations": 0,
  "termination": "tolerance_met",
  "max_deviation": 0.0008590043586327196,
  "rms_deviation": 0.00047420888496286953,
  "worst_sample": 142,
  "deviation_kind": "distance",
  "goals": [
    {
      "goal": "tolerance",
      "stated": 0.001,
      "reached": 0.0008590043586327196,
      "met": true
    }
  ],
  "curve_inflections": 0,
  "data_inflections": 0,
  "tolerance": 0.001,
  "verdict": "met",
  "between_samples": 0.6291954164427973,
  "stages": {
    "refined": 19,
    "spread": 14,
    "thinned": 10,
    "squeezed": 10,
    "reshaped": 20
  },
  "data_size": 1.006015566641491,
  "seconds": {
    "problem": 7.2677e-05,
    "choice": 2.0969e-05,
    "search": 0.11998148,
    "deviation": 5.1108e-05,
    "total": 0.120126234
  }
}
