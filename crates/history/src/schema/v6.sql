-- Schema 6: the values of a closed run side by side, for statistics over many runs. Derived from measurement.

CREATE TABLE series (
  run_id INTEGER NOT NULL                 -- the closed run
    REFERENCES run (id),
  parameter_id INTEGER NOT NULL           -- what was measured
    REFERENCES parameter (id),
  first_part INTEGER NOT NULL,            -- row number of the first part that has a counted value
  last_part INTEGER NOT NULL,             -- row number of the last one
  packed BLOB NOT NULL,                   -- counted values of production parts in order of judgement, f64, little endian
  PRIMARY KEY (run_id, parameter_id)
) STRICT;
