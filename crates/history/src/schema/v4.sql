-- Schema 4: what was seen of a part that did not pass, sample by sample.

CREATE TABLE curve (
  part_id INTEGER NOT NULL                -- the part, never one that passed
    REFERENCES part (id),
  signal TEXT NOT NULL,                   -- name of the point that was sampled
  unit TEXT NOT NULL,                     -- V, A, or empty for bits and counts
  step REAL NOT NULL                      -- a value is its packed integer times this
    CHECK (step > 0),
  begin_us INTEGER NOT NULL,              -- when the first sample was taken
  samples INTEGER NOT NULL                -- how many there are
    CHECK (samples > 0),
  packed BLOB NOT NULL,                   -- per sample the microseconds and the steps since the one before, see history/curve.rs
  PRIMARY KEY (part_id, signal)
) STRICT, WITHOUT ROWID;
