-- Schema 1 of the database behind many rigs. A released step is never edited; the next change is v2.sql.
-- Rows of parts never change: what becomes known later is a further row. A number of a rig's own file becomes unique over
-- all rigs by the number of the history in its upper bits: history * 2^40 + row number of the file.
-- Times are microseconds since 1970-01-01 UTC. Texts compare by bytes, as in the file of a rig.

CREATE TABLE relayrig.schema_step (
  step integer PRIMARY KEY,
  at timestamptz NOT NULL DEFAULT now(),
  program text NOT NULL
);
COMMENT ON TABLE relayrig.schema_step IS 'Steps of the schema that this database has';

CREATE TABLE relayrig.rig (
  id integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  site text COLLATE "C" NOT NULL,
  rig text COLLATE "C" NOT NULL,
  UNIQUE (site, rig)
);
COMMENT ON TABLE relayrig.rig IS 'Rigs, by plant and name as fleet.toml of the rig has them';

CREATE TABLE relayrig.history (
  id integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  rig_id integer NOT NULL REFERENCES relayrig.rig,
  epoch integer NOT NULL CHECK (epoch >= 1),
  uuid text NOT NULL UNIQUE,
  host text NOT NULL,
  program text NOT NULL,
  begun_at timestamptz NOT NULL DEFAULT now(),
  UNIQUE (rig_id, epoch)
);
COMMENT ON TABLE relayrig.history IS 'Files of a rig, one after the other; only that with the highest epoch may send';
COMMENT ON COLUMN relayrig.history.uuid IS 'Name that the file gave itself for this database';
COMMENT ON COLUMN relayrig.history.host IS 'Computer that sent first';

CREATE TABLE relayrig.batch (
  uuid text PRIMARY KEY,
  history_id integer NOT NULL REFERENCES relayrig.history,
  number bigint NOT NULL CHECK (number >= 1),
  watermark bigint NOT NULL,
  parts integer NOT NULL,
  rig_clock timestamptz NOT NULL,
  at timestamptz NOT NULL DEFAULT now(),
  UNIQUE (history_id, number)
);
COMMENT ON TABLE relayrig.batch IS 'Transactions of a rig; the unique number keeps two programs from mixing their rows';
COMMENT ON COLUMN relayrig.batch.watermark IS 'Last entry of the queue in the file of the rig that is here';
COMMENT ON COLUMN relayrig.batch.rig_clock IS 'Clock of the rig when it sent; at is the clock of the database';

CREATE TABLE relayrig.recipe (
  hash text PRIMARY KEY,
  name text COLLATE "C" NOT NULL,
  body text NOT NULL,
  first_used_us bigint NOT NULL
);
COMMENT ON TABLE relayrig.recipe IS 'Recipes as they were when a rig first used them';
COMMENT ON COLUMN relayrig.recipe.hash IS 'SHA-256 of body, hexadecimal';

CREATE TABLE relayrig.parameter (
  id integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  key text COLLATE "C" NOT NULL UNIQUE,
  meaning text NOT NULL
);
COMMENT ON TABLE relayrig.parameter IS 'What is measured; the key ends with the unit';

CREATE TABLE relayrig.run (
  id bigint PRIMARY KEY,
  history_id integer NOT NULL REFERENCES relayrig.history,
  uuid text NOT NULL UNIQUE,
  lot text COLLATE "C" NOT NULL,
  number integer NOT NULL CHECK (number >= 1),
  recipe_hash text NOT NULL REFERENCES relayrig.recipe,
  opened_at_us bigint NOT NULL,
  source text COLLATE "C" NOT NULL CHECK (source IN ('rig', 'simulated', 'import')),
  seed text,
  written_by text NOT NULL
);
CREATE INDEX run_lot ON relayrig.run (lot, history_id);
CREATE INDEX run_history ON relayrig.run (history_id, opened_at_us);
COMMENT ON TABLE relayrig.run IS 'Runs of lots as they began; their end is an event';

CREATE TABLE relayrig.part (
  id bigint NOT NULL,
  history_id integer NOT NULL,
  run_id bigint NOT NULL,
  kind text COLLATE "C" NOT NULL,
  seq bigint NOT NULL,
  serial text COLLATE "C",
  verdict text COLLATE "C" NOT NULL,
  bin text COLLATE "C",
  reasons text NOT NULL,
  judged_at_us bigint NOT NULL,
  test_s double precision,
  cycle_s double precision,
  landed_bin text COLLATE "C",
  landed_at_us bigint,
  PRIMARY KEY (id, judged_at_us)
) PARTITION BY RANGE (judged_at_us);
CREATE INDEX part_run ON relayrig.part (run_id, verdict);
CREATE INDEX part_time ON relayrig.part (history_id, judged_at_us);
CREATE INDEX part_serial ON relayrig.part (serial) WHERE serial IS NOT NULL;
COMMENT ON TABLE relayrig.part IS 'Parts as they were when they were sent, partitions by month of judgement; part_now has them as they are';
COMMENT ON COLUMN relayrig.part.id IS 'history * 2^40 + row number in the file of the rig; grows in order of judgement';
COMMENT ON COLUMN relayrig.part.kind IS 'lot: production; golden: reference part';
COMMENT ON COLUMN relayrig.part.seq IS 'Count of parts of this kind that entered the nest in the run';
COMMENT ON COLUMN relayrig.part.reasons IS 'Why it is no pass, JSON array of texts';

CREATE TABLE relayrig.part_change (
  event bigint NOT NULL,
  part_id bigint NOT NULL,
  judged_at_us bigint NOT NULL,
  verdict text COLLATE "C" NOT NULL,
  bin text COLLATE "C",
  reasons text NOT NULL,
  cycle_s double precision,
  landed_bin text COLLATE "C",
  landed_at_us bigint,
  PRIMARY KEY (part_id, event)
);
COMMENT ON TABLE relayrig.part_change IS 'What became known of a part after it was sent: where it landed, that its test was interrupted';

CREATE TABLE relayrig.reason (
  part_id bigint NOT NULL,
  n integer NOT NULL,
  code text COLLATE "C" NOT NULL,
  parameter_id integer,
  side text COLLATE "C",
  detail text NOT NULL,
  PRIMARY KEY (part_id, n)
);
CREATE INDEX reason_code ON relayrig.reason (code, parameter_id);
COMMENT ON TABLE relayrig.reason IS 'Why parts did not pass, as codes';

CREATE TABLE relayrig.measurement (
  part_id bigint NOT NULL,
  run_id bigint NOT NULL,
  judged_at_us bigint NOT NULL,
  parameter_id integer NOT NULL,
  attempt integer NOT NULL,
  value double precision,
  uncertainty double precision,
  low double precision,
  high double precision,
  verdict text COLLATE "C" NOT NULL,
  population text COLLATE "C",
  budget text
) PARTITION BY RANGE (judged_at_us);
CREATE INDEX measurement_part ON relayrig.measurement (part_id);
CREATE INDEX measurement_value ON relayrig.measurement (run_id, parameter_id, value) WHERE population IS NOT NULL;
COMMENT ON TABLE relayrig.measurement IS 'Measurements, with the part in one transaction; a part is inserted once, so are they';
COMMENT ON COLUMN relayrig.measurement.uncertainty IS 'Expanded, k = 2, unit of the parameter';
COMMENT ON COLUMN relayrig.measurement.population IS 'Kind of the part on the attempt that statistics count, else null';
COMMENT ON COLUMN relayrig.measurement.budget IS 'Budget of the uncertainty, JSON';

CREATE TABLE relayrig.sample (
  part_id bigint NOT NULL,
  judged_at_us bigint NOT NULL,
  parameter_id integer NOT NULL,
  attempt integer NOT NULL,
  n integer NOT NULL,
  line text NOT NULL,
  module text NOT NULL,
  channel text NOT NULL,
  command text NOT NULL,
  raw text NOT NULL,
  at_us bigint NOT NULL
) PARTITION BY RANGE (judged_at_us);
CREATE INDEX sample_part ON relayrig.sample (part_id);
COMMENT ON TABLE relayrig.sample IS 'Raw replies, as far as fleet.toml of the rig sends them';

CREATE TABLE relayrig.curve (
  part_id bigint NOT NULL,
  signal text NOT NULL,
  unit text NOT NULL,
  step double precision NOT NULL,
  begin_us bigint NOT NULL,
  samples bigint NOT NULL,
  packed bytea NOT NULL,
  PRIMARY KEY (part_id, signal)
);
COMMENT ON TABLE relayrig.curve IS 'Sampled curves of parts that did not pass, packed as in the file of the rig';

CREATE TABLE relayrig.event (
  id bigint PRIMARY KEY,
  history_id integer NOT NULL REFERENCES relayrig.history,
  kind text COLLATE "C" NOT NULL,
  row_id bigint NOT NULL,
  run_id bigint,
  body jsonb NOT NULL,
  at timestamptz NOT NULL DEFAULT now()
);
CREATE INDEX event_row ON relayrig.event (kind, row_id, id);
CREATE INDEX event_history ON relayrig.event (history_id, kind, id);
COMMENT ON TABLE relayrig.event IS 'Rows of all other tables of a rig and their changes; the last event of (kind, row_id) counts';
COMMENT ON COLUMN relayrig.event.kind IS 'Table in the file of the rig';
COMMENT ON COLUMN relayrig.event.body IS 'Columns of the row';

CREATE FUNCTION relayrig.ensure_months(first_us bigint, last_us bigint) RETURNS integer
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
DECLARE
  month timestamp := date_trunc('month', to_timestamp(first_us / 1000000) AT TIME ZONE 'UTC');
  last timestamp := to_timestamp(last_us / 1000000) AT TIME ZONE 'UTC';
  made integer := 0;
  low bigint;
  high bigint;
  base text;
BEGIN
  IF last - month > interval '100 years' OR month < '1970-01-01' OR last > '2200-01-01' THEN
    RAISE EXCEPTION 'months from % to %: found a span outside of 1970 to 2200', month, last;
  END IF;
  PERFORM pg_advisory_xact_lock(7165926);
  WHILE month <= last LOOP
    low := (extract(epoch FROM month) * 1000000)::bigint;
    high := (extract(epoch FROM month + interval '1 month') * 1000000)::bigint;
    FOREACH base IN ARRAY ARRAY['part', 'measurement', 'sample'] LOOP
      IF to_regclass(format('relayrig.%I', base || to_char(month, '_YYYY_MM'))) IS NULL THEN
        EXECUTE format('CREATE TABLE relayrig.%I PARTITION OF relayrig.%I FOR VALUES FROM (%s) TO (%s)',
          base || to_char(month, '_YYYY_MM'), base, low, high);
        made := made + 1;
      END IF;
    END LOOP;
    month := month + interval '1 month';
  END LOOP;
  RETURN made;
END $$;
COMMENT ON FUNCTION relayrig.ensure_months IS 'Makes the monthly partitions of a time span; returns how many were missing';
