-- Schema 3: gates of a lot (states, golden checks, retests), who ordered what, what became of an alarm, wear.
-- Rows of parts are not touched: a suspect part is found by the times of the checks round it.

CREATE TABLE lot_state (
  lot_id INTEGER PRIMARY KEY              -- the lot
    REFERENCES lot (id),
  state TEXT NOT NULL                     -- open: may be run; running; held: may not before somebody releases it; complete
    CHECK (state IN ('open', 'running', 'held', 'complete')),
  why TEXT,                               -- why it is held, else null
  since_us INTEGER NOT NULL               -- since when
) STRICT;

CREATE TABLE retest (
  run_id INTEGER PRIMARY KEY              -- a run that tests parts of its lot again; the first results stay
    REFERENCES run (id),
  consented_by TEXT NOT NULL              -- who agreed to it
    CHECK (length(consented_by) > 0)
) STRICT;

CREATE TABLE golden_check (
  id INTEGER PRIMARY KEY,                 -- row number
  run_id INTEGER NOT NULL                 -- the run it was made in
    REFERENCES run (id),
  at_us INTEGER NOT NULL,                 -- when it was decided
  passed INTEGER NOT NULL                 -- 1: the golden parts read as certified
    CHECK (passed IN (0, 1)),
  text TEXT NOT NULL,                     -- which parts, or what was found instead
  suspect_since_us INTEGER                -- of one that failed: the last good check before it; parts judged since are suspect
) STRICT;
CREATE INDEX golden_check_run ON golden_check (run_id, at_us);
CREATE INDEX golden_check_failed ON golden_check (at_us) WHERE NOT passed;

CREATE TABLE alarm_state (
  alarm_id INTEGER PRIMARY KEY            -- the occurrence
    REFERENCES alarm (id),
  acknowledged_at_us INTEGER,             -- when a person had seen it, null before
  acknowledged_by TEXT,                   -- who
  shelved_until_us INTEGER,               -- not shown before this, null when it was never shelved
  shelved_by TEXT,                        -- who put it there
  shelf_reason TEXT                       -- why
) STRICT;
-- Nobody could acknowledge before this schema; what is over shall not come back as unseen.
INSERT INTO alarm_state (alarm_id, acknowledged_at_us, acknowledged_by)
  SELECT id, raised_at_us, 'schema 3' FROM alarm;

CREATE TABLE ordered (
  id INTEGER PRIMARY KEY,                 -- row number, grows in order of time
  at_us INTEGER NOT NULL,                 -- when it was answered
  run_id INTEGER                          -- the run under way, null outside a run
    REFERENCES run (id),
  who TEXT NOT NULL,                      -- who ordered it, empty for a stranger
  role TEXT NOT NULL,                     -- as which role, empty for a stranger
  origin TEXT NOT NULL,                   -- from where: address of the screen, or the command line
  what TEXT NOT NULL                      -- the order with its members, JSON
    CHECK (json_valid(what)),
  refused TEXT                            -- why it was refused, null when it was taken
) STRICT;
CREATE INDEX ordered_time ON ordered (at_us);

CREATE TABLE wear (
  source TEXT NOT NULL                    -- rig or simulated
    CHECK (source IN ('rig', 'simulated')),
  name TEXT NOT NULL,                     -- what wears: probe_touches, jaw_closings
  count INTEGER NOT NULL                  -- since it was replaced
    CHECK (count >= 0),
  replaced_at_us INTEGER,                 -- when it was replaced last, null before the first time
  replaced_by TEXT,                       -- who did it
  PRIMARY KEY (source, name)
) STRICT, WITHOUT ROWID;
