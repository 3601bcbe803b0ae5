-- Schema 1. A released migration is never edited; the next change is v2.sql.
-- Times are integer microseconds since 1970-01-01 UTC. Resistances, volts and milliseconds carry
-- their unit in the parameter key. Tables are singular; the plural names are views for reading by hand.

CREATE TABLE lot (
  id INTEGER PRIMARY KEY,                 -- row number
  name TEXT NOT NULL UNIQUE               -- what the operator called the lot
    CHECK (length(name) BETWEEN 1 AND 200),
  first_opened_us INTEGER NOT NULL        -- opening of its first run
) STRICT;

CREATE TABLE recipe (
  id INTEGER PRIMARY KEY,                 -- row number
  hash TEXT NOT NULL UNIQUE,              -- SHA-256 of body, hexadecimal
  name TEXT NOT NULL,                     -- name of the recipe, for example jzc-22f-012
  body TEXT NOT NULL,                     -- the recipe as it was when first used, TOML
  first_used_us INTEGER NOT NULL          -- first run that used exactly this text
) STRICT;

CREATE TABLE calibration (
  id INTEGER PRIMARY KEY,                 -- row number
  hash TEXT NOT NULL,                     -- SHA-256 of body, hexadecimal
  made_at_us INTEGER NOT NULL,            -- when the factors were determined
  due_at_us INTEGER NOT NULL,             -- when they stop being valid
  verified INTEGER NOT NULL               -- 1 when a verification after it passed
    CHECK (verified IN (0, 1)),
  body TEXT NOT NULL                      -- factors with uncertainties, JSON
    CHECK (json_valid(body)),
  UNIQUE (hash, made_at_us)
) STRICT;

CREATE TABLE run (
  id INTEGER PRIMARY KEY,                 -- row number
  lot_id INTEGER NOT NULL                 -- the lot that was run
    REFERENCES lot (id),
  number INTEGER NOT NULL                 -- 1 for the first opening of the lot, then 2, 3 ...
    CHECK (number >= 1),
  recipe_id INTEGER NOT NULL              -- the text of the recipe in force
    REFERENCES recipe (id),
  calibration_hash TEXT,                  -- the calibration in force, null when there was none
  opened_at_us INTEGER NOT NULL,          -- begin of the run
  closed_at_us INTEGER,                   -- end of the run, null while it runs or when it was cut off
  source TEXT NOT NULL                    -- rig: measured; simulated: measured on the simulated rig; import: from a file
    CHECK (source IN ('rig', 'simulated', 'import')),
  seed TEXT,                              -- seed of the simulated rig, decimal (may exceed 63 bits)
  written_by TEXT NOT NULL,               -- program and version that wrote the run
  UNIQUE (lot_id, number)
) STRICT;
CREATE INDEX run_recipe ON run (recipe_id);

CREATE TABLE part (
  id INTEGER PRIMARY KEY,                 -- row number, grows in order of judgement
  run_id INTEGER NOT NULL                 -- the run that tested it
    REFERENCES run (id),
  kind TEXT NOT NULL                      -- lot: production; golden: reference part run before the lot
    CHECK (kind IN ('lot', 'golden')),
  seq INTEGER NOT NULL                    -- count of parts that entered the nest, from 1
    CHECK (seq >= 0),
  serial TEXT,                            -- serial number when the part has one
  verdict TEXT NOT NULL                   -- pass, fail, void (could not judge), unjudged (imported without a verdict)
    CHECK (verdict IN ('pass', 'fail', 'void', 'unjudged')),
  bin TEXT,                               -- the bin the verdict asks for
  reasons TEXT NOT NULL                   -- why it is not a pass, JSON array of texts
    CHECK (json_valid(reasons)),
  judged_at_us INTEGER NOT NULL,          -- when the verdict stood
  test_s REAL,                            -- probes up to verdict, rig seconds
  cycle_s REAL,                           -- since the previous part left the nest, rig seconds
  landed_bin TEXT,                        -- the bin whose beam saw it fall, null when none did
  landed_at_us INTEGER,                   -- when the beam saw it
  UNIQUE (run_id, kind, seq)
) STRICT;
CREATE INDEX part_run_verdict ON part (run_id, verdict, kind);
CREATE INDEX part_run_bin ON part (run_id, bin);
CREATE INDEX part_time ON part (judged_at_us, verdict, kind);
CREATE INDEX part_serial ON part (serial) WHERE serial IS NOT NULL;

CREATE TABLE parameter (
  id INTEGER PRIMARY KEY,                 -- row number
  key TEXT NOT NULL UNIQUE                -- key with the unit as suffix, the same in recipes, rows and files
    CHECK (length(key) BETWEEN 1 AND 100),
  meaning TEXT NOT NULL                   -- what is measured
) STRICT;

CREATE TABLE measurement (
  part_id INTEGER NOT NULL                -- the part measured
    REFERENCES part (id),
  parameter_id INTEGER NOT NULL           -- what was measured
    REFERENCES parameter (id),
  attempt INTEGER NOT NULL                -- 1, or more when it was measured again
    CHECK (attempt >= 0),
  value REAL,                             -- in the unit of the parameter key, null when there is none
  uncertainty REAL,                       -- expanded, k = 2, same unit
  low REAL,                               -- lower limit of the recipe, null when there is none
  high REAL,                              -- upper limit of the recipe, null when there is none
  verdict TEXT NOT NULL                   -- pass, fail, void or unjudged, of this attempt alone
    CHECK (verdict IN ('pass', 'fail', 'void', 'unjudged')),
  budget TEXT                             -- the uncertainty budget, JSON
    CHECK (budget IS NULL OR json_valid(budget)),
  run_id INTEGER NOT NULL,                -- copy of part.run_id, for the index of values
  part_verdict TEXT NOT NULL,             -- copy of part.verdict, for the index of values
  population TEXT                         -- copy of part.kind on the attempt that statistics count, else null
    CHECK (population IN ('lot', 'golden')),
  PRIMARY KEY (part_id, parameter_id, attempt)
) STRICT, WITHOUT ROWID;
CREATE INDEX measurement_value
  ON measurement (parameter_id, population, run_id, part_verdict, value) WHERE population IS NOT NULL;

CREATE TABLE sample (
  part_id INTEGER NOT NULL,               -- the part measured
  parameter_id INTEGER NOT NULL,          -- the measurement it went into
  attempt INTEGER NOT NULL,               -- the attempt it went into
  n INTEGER NOT NULL,                     -- order within the attempt, from 1
  line TEXT NOT NULL,                     -- serial line
  module TEXT NOT NULL,                   -- address of the module on the line
  channel TEXT NOT NULL,                  -- channel of the module, empty when the reply is of the whole module
  command TEXT NOT NULL,                  -- text sent, without carriage return
  raw TEXT NOT NULL,                      -- text received, without carriage return
  at_us INTEGER NOT NULL,                 -- when the reply was complete
  PRIMARY KEY (part_id, parameter_id, attempt, n),
  FOREIGN KEY (part_id, parameter_id, attempt) REFERENCES measurement (part_id, parameter_id, attempt)
) STRICT, WITHOUT ROWID;

CREATE TABLE alarm (
  id INTEGER PRIMARY KEY,                 -- row number
  run_id INTEGER                          -- the run it happened in, null outside a run
    REFERENCES run (id),
  code TEXT NOT NULL,                     -- what kind of trouble
  line TEXT,                              -- serial line, when it concerns one
  text TEXT NOT NULL,                     -- the message as shown
  raised_at_us INTEGER NOT NULL,          -- when it came
  cleared_at_us INTEGER                   -- when it went, null while it stands
) STRICT;
CREATE UNIQUE INDEX alarm_once ON alarm (raised_at_us, code, ifnull(line, ''), ifnull(run_id, 0));
CREATE INDEX alarm_run ON alarm (run_id);

INSERT INTO parameter (id, key, meaning) VALUES
  (1, 'coil_resistance_ohm', 'DC coil resistance at the reference temperature of the recipe'),
  (2, 'operate_voltage_v', 'quasi-static must-operate threshold at the reference temperature'),
  (3, 'release_voltage_v', 'quasi-static must-release threshold at the reference temperature'),
  (4, 'operate_time_ms', 'nominal voltage applied to first make of NO, bounce excluded'),
  (5, 'release_time_ms', 'nominal voltage removed to first make of NC, bounce excluded'),
  (6, 'operate_bounce_ms', 'open time of NO after its first make'),
  (7, 'release_bounce_ms', 'open time of NC after its first make'),
  (8, 'contact_resistance_no_mohm', 'four-wire resistance of the NO contact, thermal EMF removed'),
  (9, 'contact_resistance_nc_mohm', 'four-wire resistance of the NC contact, thermal EMF removed');
