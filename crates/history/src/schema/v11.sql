-- Schema 11: the rig that a history belongs to, and lots that an engineer reopened.

CREATE TABLE rig (
  id INTEGER PRIMARY KEY                  -- one row: a file belongs to one rig; none before the first run
    CHECK (id = 1),
  source TEXT NOT NULL                    -- rig: a real one; simulated: the simulated one
    CHECK (source IN ('rig', 'simulated'))
) STRICT;
-- A file with rows of both belongs to the real rig.
INSERT INTO rig (id, source)
  SELECT 1, source FROM (
    SELECT source FROM run WHERE source <> 'import'
    UNION SELECT source FROM wear
    UNION SELECT source FROM inside
    UNION SELECT iif(body ->> 'simulated', 'simulated', 'rig') FROM calibration
  ) ORDER BY source LIMIT 1;

ALTER TABLE lot_state ADD COLUMN completed INTEGER NOT NULL DEFAULT 0 -- 1 since the lot was complete: it is open only after a reopening
  CHECK (completed IN (0, 1));
UPDATE lot_state SET completed = 1 WHERE state = 'complete';

CREATE TABLE reopening (
  id INTEGER PRIMARY KEY,                 -- row number
  lot_id INTEGER NOT NULL                 -- the complete lot that was opened again
    REFERENCES lot (id),
  at_us INTEGER NOT NULL,                 -- when
  who TEXT NOT NULL,                      -- who decided it
  why TEXT NOT NULL                       -- reason
    CHECK (length(why) > 0)
) STRICT;
CREATE INDEX reopening_lot ON reopening (lot_id);
