-- Schema 15: rows on their way to the databases that collect many rigs. A run gets a name that no other run of any rig has;
-- each target has a queue of rows that it does not have yet, filled by triggers in the transaction that writes the row.
-- A history without targets queues nothing.

ALTER TABLE run ADD COLUMN uuid TEXT; -- UUID (version 4) of the run, unique over all rigs
UPDATE run SET uuid = lower(format('%s-%s-4%s-8%s-%s', hex(randomblob(4)), hex(randomblob(2)),
  substr(hex(randomblob(2)), 2), substr(hex(randomblob(2)), 2), hex(randomblob(6))));
CREATE UNIQUE INDEX run_uuid ON run (uuid);

CREATE TABLE target (
  id INTEGER PRIMARY KEY,                 -- row number
  url TEXT NOT NULL UNIQUE,               -- database, as fleet.toml names it
  identity TEXT NOT NULL,                 -- UUID by which the database knows this file; a takeover gives a new one
  sent INTEGER NOT NULL DEFAULT 0         -- number of batches that the database has confirmed
    CHECK (sent >= 0),
  confirmed TEXT,                         -- UUID of the last batch that the database has confirmed, null before the first
  watermark INTEGER NOT NULL DEFAULT 0,   -- last row of outbox in that batch
  pending TEXT,                           -- UUID of a batch that was sent and may have arrived, null when none is under way
  pending_to INTEGER,                     -- last row of outbox in it
  CHECK ((pending IS NULL) = (pending_to IS NULL))
) STRICT;

CREATE TABLE outbox (
  id INTEGER PRIMARY KEY AUTOINCREMENT,   -- order of events; a number is never used twice
  target_id INTEGER NOT NULL              -- the database that lacks the row
    REFERENCES target (id),
  kind TEXT NOT NULL,                     -- table, or part_change for what became known of a part later
  row_id INTEGER NOT NULL                 -- row number in that table
) STRICT;
CREATE INDEX outbox_next ON outbox (target_id, id);
CREATE INDEX outbox_row ON outbox (kind, row_id);

-- Row numbers that pruning has freed; SQLite would give them to new rows, and a target would take those for the old ones.
CREATE TABLE row_floor (
  name TEXT PRIMARY KEY                   -- table
    CHECK (name IN ('part', 'alarm')),
  last INTEGER NOT NULL                   -- highest number that a row ever had when rows were deleted
) STRICT, WITHOUT ROWID;

CREATE TRIGGER outbox_run AFTER INSERT ON run BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'run', NEW.id FROM target; END;
CREATE TRIGGER outbox_run_state AFTER UPDATE ON run BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'run_state', NEW.id FROM target; END;
CREATE TRIGGER outbox_part AFTER INSERT ON part BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'part', NEW.id FROM target; END;
CREATE TRIGGER outbox_part_change AFTER UPDATE ON part BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'part_change', NEW.id FROM target; END;
CREATE TRIGGER outbox_alarm AFTER INSERT ON alarm BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'alarm', NEW.id FROM target; END;
CREATE TRIGGER outbox_alarm_cleared AFTER UPDATE ON alarm BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'alarm', NEW.id FROM target; END;
CREATE TRIGGER outbox_alarm_state AFTER INSERT ON alarm_state BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'alarm_state', NEW.alarm_id FROM target; END;
CREATE TRIGGER outbox_alarm_state_change AFTER UPDATE ON alarm_state BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'alarm_state', NEW.alarm_id FROM target; END;
CREATE TRIGGER outbox_lot_state AFTER INSERT ON lot_state BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'lot_state', NEW.lot_id FROM target; END;
CREATE TRIGGER outbox_lot_state_change AFTER UPDATE ON lot_state BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'lot_state', NEW.lot_id FROM target; END;
CREATE TRIGGER outbox_run_end AFTER INSERT ON run_end BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'run_end', NEW.run_id FROM target; END;
CREATE TRIGGER outbox_retest AFTER INSERT ON retest BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'retest', NEW.run_id FROM target; END;
CREATE TRIGGER outbox_golden_check AFTER INSERT ON golden_check BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'golden_check', NEW.id FROM target; END;
CREATE TRIGGER outbox_ordered AFTER INSERT ON ordered BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'ordered', NEW.id FROM target; END;
CREATE TRIGGER outbox_reopening AFTER INSERT ON reopening BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'reopening', NEW.id FROM target; END;
CREATE TRIGGER outbox_calibration AFTER INSERT ON calibration BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'calibration', NEW.id FROM target; END;
CREATE TRIGGER outbox_calibration_change AFTER UPDATE ON calibration BEGIN
  INSERT INTO outbox (target_id, kind, row_id) SELECT id, 'calibration', NEW.id FROM target; END;

CREATE INDEX ordered_run ON ordered (run_id); -- the scans of a run, whatever the clock said meanwhile
