-- Schema 2: what has left the history whole, so that only such runs may be pruned.

CREATE TABLE export (
  run_id INTEGER PRIMARY KEY              -- the closed run that was copied whole
    REFERENCES run (id),
  at_us INTEGER NOT NULL,                 -- when its copy was complete
  file TEXT NOT NULL,                     -- the copy
  parts INTEGER NOT NULL,                 -- parts of all kinds that the run had then
  pruned_at_us INTEGER                    -- when its parts were deleted here, null while they are kept
) STRICT;
