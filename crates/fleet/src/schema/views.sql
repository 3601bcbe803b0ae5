-- Views and rights, made anew by each `fleet init`: what is, by the names that the file of a rig has, and for people.

CREATE OR REPLACE VIEW relayrig.part_now AS
  SELECT part.id, part.history_id, part.run_id, part.kind, part.seq, part.serial,
    coalesce(last.verdict, part.verdict) AS verdict,
    CASE WHEN last.event IS NULL THEN part.bin ELSE last.bin END AS bin,
    coalesce(last.reasons, part.reasons) AS reasons, part.judged_at_us, part.test_s,
    CASE WHEN last.event IS NULL THEN part.cycle_s ELSE last.cycle_s END AS cycle_s,
    coalesce(last.landed_bin, part.landed_bin) AS landed_bin,
    coalesce(last.landed_at_us, part.landed_at_us) AS landed_at_us
  FROM relayrig.part LEFT JOIN LATERAL (SELECT * FROM relayrig.part_change AS it WHERE it.part_id = part.id
    ORDER BY it.event DESC LIMIT 1) AS last ON true;
COMMENT ON VIEW relayrig.part_now IS 'Parts with what became known of them';

CREATE OR REPLACE VIEW relayrig.row_now AS
  SELECT DISTINCT ON (kind, row_id) kind, row_id, history_id, run_id, body FROM relayrig.event
  ORDER BY kind, row_id, id DESC;
COMMENT ON VIEW relayrig.row_now IS 'Last event of each row';

CREATE OR REPLACE VIEW relayrig.run_now AS
  SELECT rig.site, rig.rig, history.epoch, run.*, recipe.name AS recipe,
    (state.body ->> 'closed_at_us')::bigint AS closed_at_us, state.body ->> 'calibration_hash' AS calibration_hash,
    ending.body ->> 'ended' AS ended, ending.body ->> 'cause' AS cause, ending.body ->> 'cause_text' AS cause_text
  FROM relayrig.run JOIN relayrig.history ON history.id = run.history_id JOIN relayrig.rig ON rig.id = history.rig_id
    JOIN relayrig.recipe ON recipe.hash = run.recipe_hash
    LEFT JOIN LATERAL (SELECT body FROM relayrig.event WHERE kind = 'run_state' AND row_id = run.id
      ORDER BY id DESC LIMIT 1) AS state ON true
    LEFT JOIN LATERAL (SELECT body FROM relayrig.event WHERE kind = 'run_end' AND row_id = run.id
      ORDER BY id DESC LIMIT 1) AS ending ON true;
COMMENT ON VIEW relayrig.run_now IS 'Runs with rig, recipe and end';

CREATE OR REPLACE VIEW relayrig.lots AS
  SELECT run.site, run.rig, run.lot, run.number AS run, run.recipe, run.source, run.seed,
    to_timestamp(run.opened_at_us / 1e6) AS opened, to_timestamp(run.closed_at_us / 1e6) AS closed, counts.parts,
    counts.pass, counts.fail, counts.void,
    round(100.0 * counts.pass / nullif(counts.pass + counts.fail + counts.void, 0), 2) AS yield_percent,
    run.ended, run.cause, run.cause_text
  FROM relayrig.run_now AS run LEFT JOIN LATERAL (SELECT count(*) AS parts,
      count(*) FILTER (WHERE verdict = 'pass') AS pass, count(*) FILTER (WHERE verdict = 'fail') AS fail,
      count(*) FILTER (WHERE verdict = 'void') AS void
    FROM relayrig.part_now AS part WHERE part.run_id = run.id AND part.kind = 'lot') AS counts ON true;
COMMENT ON VIEW relayrig.lots IS 'Runs of lots with their counts';

CREATE OR REPLACE VIEW relayrig.parts AS
  SELECT run.site, run.rig, run.lot, run.number AS run, part.kind, part.seq,
    to_timestamp(part.judged_at_us / 1e6) AS judged, run.recipe, part.serial, part.verdict, part.bin,
    part.landed_bin, (SELECT string_agg(value, '; ') FROM jsonb_array_elements_text(part.reasons::jsonb)) AS reasons,
    part.test_s, part.cycle_s, measured.measured
  FROM relayrig.part_now AS part JOIN relayrig.run_now AS run ON run.id = part.run_id
    LEFT JOIN LATERAL (SELECT jsonb_object_agg(parameter.key, m.value ORDER BY m.attempt) AS measured
      FROM relayrig.measurement AS m JOIN relayrig.parameter ON parameter.id = m.parameter_id
      WHERE m.part_id = part.id AND m.judged_at_us = part.judged_at_us) AS measured ON true;
COMMENT ON VIEW relayrig.parts IS 'Parts; measured has the last value of each parameter';

CREATE OR REPLACE VIEW relayrig.measurements AS
  SELECT run.site, run.rig, run.lot, run.number AS run, part.kind, part.seq, parameter.key AS parameter,
    m.attempt, m.value, m.uncertainty, m.low, m.high, m.verdict, m.budget
  FROM relayrig.measurement AS m JOIN relayrig.part ON part.id = m.part_id AND part.judged_at_us = m.judged_at_us
    JOIN relayrig.run_now AS run ON run.id = part.run_id JOIN relayrig.parameter ON parameter.id = m.parameter_id;
COMMENT ON VIEW relayrig.measurements IS 'All attempts';

CREATE OR REPLACE VIEW relayrig.samples AS
  SELECT run.site, run.rig, run.lot, run.number AS run, part.kind, part.seq, parameter.key AS parameter,
    s.attempt, s.n, s.line, s.module, s.channel, s.command, s.raw, to_timestamp(s.at_us / 1e6) AS at
  FROM relayrig.sample AS s JOIN relayrig.part ON part.id = s.part_id AND part.judged_at_us = s.judged_at_us
    JOIN relayrig.run_now AS run ON run.id = part.run_id JOIN relayrig.parameter ON parameter.id = s.parameter_id;
COMMENT ON VIEW relayrig.samples IS 'Raw replies';

CREATE OR REPLACE VIEW relayrig.reasons AS
  SELECT run.site, run.rig, run.lot, run.number AS run, part.kind, part.seq, reason.n, reason.code,
    parameter.key AS parameter, reason.side, reason.detail
  FROM relayrig.reason JOIN relayrig.part ON part.id = reason.part_id
    JOIN relayrig.run_now AS run ON run.id = part.run_id
    LEFT JOIN relayrig.parameter ON parameter.id = reason.parameter_id;
COMMENT ON VIEW relayrig.reasons IS 'Why parts did not pass';

CREATE OR REPLACE VIEW relayrig.curves AS
  SELECT run.site, run.rig, run.lot, run.number AS run, part.kind, part.seq, curve.signal, curve.unit,
    to_timestamp(curve.begin_us / 1e6) AS begin, curve.samples, length(curve.packed) AS bytes
  FROM relayrig.curve JOIN relayrig.part ON part.id = curve.part_id
    JOIN relayrig.run_now AS run ON run.id = part.run_id;
COMMENT ON VIEW relayrig.curves IS 'Which curves there are';

CREATE OR REPLACE VIEW relayrig.alarms AS
  SELECT rig.site, rig.rig, run.lot, run.number AS run, alarm.body ->> 'code' AS code, alarm.body ->> 'line' AS line,
    alarm.body ->> 'text' AS text, to_timestamp((alarm.body ->> 'raised_at_us')::bigint / 1e6) AS raised,
    to_timestamp((alarm.body ->> 'cleared_at_us')::bigint / 1e6) AS cleared
  FROM relayrig.row_now AS alarm JOIN relayrig.history ON history.id = alarm.history_id
    JOIN relayrig.rig ON rig.id = history.rig_id LEFT JOIN relayrig.run ON run.id = alarm.run_id
  WHERE alarm.kind = 'alarm';
COMMENT ON VIEW relayrig.alarms IS 'Occurrences of alarms';

CREATE OR REPLACE VIEW relayrig.external_results AS
  SELECT rig.site, rig.rig, it.body ->> 'lot' AS lot, it.body ->> 'serial' AS serial, (it.body ->> 'run')::bigint AS run,
    (it.body ->> 'seq')::bigint AS seq, it.body ->> 'key' AS parameter, (it.body ->> 'value')::double precision AS value,
    (it.body ->> 'uncertainty')::double precision AS uncertainty, (it.body ->> 'low')::double precision AS low,
    (it.body ->> 'high')::double precision AS high, it.body ->> 'verdict' AS verdict,
    it.row_id < max(it.row_id) OVER (PARTITION BY it.history_id, it.body ->> 'lot', it.body ->> 'key',
      it.body ->> 'serial', it.body ->> 'run', it.body ->> 'seq') AS superseded,
    it.body ->> 'who' AS who, to_timestamp((it.body ->> 'measured_at_us')::bigint / 1e6) AS measured,
    to_timestamp((it.body ->> 'entered_at_us')::bigint / 1e6) AS entered, it.body ->> 'file_hash' AS file_hash,
    (it.body ->> 'line')::bigint AS line, it.body ->> 'recipe_hash' AS recipe_hash
  FROM relayrig.row_now AS it JOIN relayrig.history ON history.id = it.history_id
    JOIN relayrig.rig ON rig.id = history.rig_id
  WHERE it.kind = 'external_result';
COMMENT ON VIEW relayrig.external_results IS 'Results from outside of the rig; those that a later one supersedes do not count';

DO $$ BEGIN
  IF to_regrole('relayrig_writer') IS NULL THEN CREATE ROLE relayrig_writer NOLOGIN; END IF;
  IF to_regrole('relayrig_reader') IS NULL THEN CREATE ROLE relayrig_reader NOLOGIN; END IF;
END $$;
GRANT USAGE ON SCHEMA relayrig TO relayrig_writer, relayrig_reader;
GRANT SELECT ON ALL TABLES IN SCHEMA relayrig TO relayrig_writer, relayrig_reader;
GRANT INSERT ON relayrig.rig, relayrig.history, relayrig.batch, relayrig.recipe, relayrig.parameter, relayrig.run,
  relayrig.part, relayrig.part_change, relayrig.reason, relayrig.measurement, relayrig.sample, relayrig.curve,
  relayrig.event TO relayrig_writer;
REVOKE ALL ON FUNCTION relayrig.ensure_months FROM PUBLIC;
GRANT EXECUTE ON FUNCTION relayrig.ensure_months TO relayrig_writer;
