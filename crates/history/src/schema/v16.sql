-- Schema 16: batches of parts that were tested together, with the curves of their chamber.

CREATE TABLE batch (
  id INTEGER PRIMARY KEY,                 -- row number
  run_id INTEGER NOT NULL                 -- run of the batch
    REFERENCES run (id),
  number INTEGER NOT NULL                 -- number of the batch in its run, from 1
    CHECK (number > 0),
  begin_us INTEGER NOT NULL,              -- time zero of the curves
  ended_us INTEGER NOT NULL,              -- when the test ended
  UNIQUE (run_id, number)
) STRICT;

CREATE TABLE batch_curve (
  batch_id INTEGER NOT NULL               -- batch of the curve
    REFERENCES batch (id),
  signal TEXT NOT NULL,                   -- set_point, reference, rate, or socket_ with its number: 1 open, 0 closed
  seq INTEGER                             -- number of the part in the socket; null for the chamber
    CHECK (seq > 0),
  unit TEXT NOT NULL,                     -- unit of the values, empty for a contact
  step REAL NOT NULL                      -- resolution, in that unit
    CHECK (step > 0),
  begin_us INTEGER NOT NULL,              -- time of the first sample
  samples INTEGER NOT NULL                -- number of samples
    CHECK (samples > 0),
  packed BLOB NOT NULL,                   -- samples, in the code of the table curve
  PRIMARY KEY (batch_id, signal)
) STRICT, WITHOUT ROWID;
