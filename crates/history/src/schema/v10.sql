-- Schema 10: how a run ended, and the cause when it ended in trouble. A table and not columns of run: a run that was cut off has
-- no row, and one that was closed before this schema has none either.

CREATE TABLE run_end (
  run_id INTEGER PRIMARY KEY              -- the run
    REFERENCES run (id),
  ended TEXT NOT NULL                     -- as the exit status of the program tells: 0, 4 or 3
    CHECK (ended IN ('complete', 'stopped', 'alarm')),
  cause TEXT                              -- code of the alarm, or why the program could not go on; null without trouble
    CHECK (length(cause) BETWEEN 1 AND 100),
  cause_text TEXT                         -- what happened, English
    CHECK ((cause_text IS NULL) = (cause IS NULL))
) STRICT;
