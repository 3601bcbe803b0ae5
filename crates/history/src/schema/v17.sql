-- Schema 17: results that a plant measures outside of the rig on samples of a lot. A row never changes; a correction is a
-- further row. Of the rows of a lot with equal key, serial, run and seq the last one counts.

CREATE TABLE external_result (
  id INTEGER PRIMARY KEY,                 -- row number, grows in order of entry
  lot_id INTEGER NOT NULL                 -- lot of the sample
    REFERENCES lot (id),
  serial TEXT                             -- serial number of the sample, when it has one
    CHECK (serial <> ''),
  run INTEGER                             -- run that tested a sample without serial number
    CHECK (run >= 1),
  seq INTEGER                             -- number of that sample in its run; no serial and no seq: a result of the lot
    CHECK (seq >= 1),
  key TEXT NOT NULL                       -- what was measured; ends with the unit
    CHECK (length(key) BETWEEN 1 AND 100),
  value REAL NOT NULL,                    -- in the unit of the key
  uncertainty REAL                        -- expanded, k = 2, same unit; null when it was not stated
    CHECK (uncertainty > 0),
  low REAL,                               -- lower limit of the recipe, null when there is none
  high REAL,                              -- upper limit of the recipe, null when there is none
  verdict TEXT NOT NULL                   -- by limit and rule of the recipe; undecided: within U of the limit
    CHECK (verdict IN ('pass', 'fail', 'undecided')),
  recipe_hash TEXT NOT NULL               -- recipe of the lot, which judged
    REFERENCES recipe (hash),
  who TEXT NOT NULL                       -- who entered it
    CHECK (trim(who) <> ''),
  measured_at_us INTEGER NOT NULL,        -- when it was measured; when it was entered, if the person stated no time
  entered_at_us INTEGER NOT NULL,         -- when it was entered
  file_hash TEXT,                         -- SHA-256 of the imported file, hexadecimal; null when it was typed in
  line INTEGER,                           -- line in that file
  CHECK ((run IS NULL) = (seq IS NULL)),
  CHECK (serial IS NULL OR seq IS NULL),
  CHECK ((file_hash IS NULL) = (line IS NULL)),
  UNIQUE (lot_id, file_hash, line)
) STRICT;

CREATE TRIGGER external_result_stays BEFORE UPDATE ON external_result BEGIN
  SELECT raise(ABORT, 'a result never changes: enter another one'); END;
CREATE TRIGGER external_result_remains BEFORE DELETE ON external_result BEGIN
  SELECT raise(ABORT, 'a result is never deleted: enter another one'); END;
CREATE TRIGGER outbox_external_result AFTER INSERT ON external_result BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'external_result', NEW.id FROM target; END;
