-- Schema 2: the few parts that were judged otherwise after they were sent, so that counts by verdict need no other change.

CREATE TABLE relayrig.part_rejudged (
  part_id bigint NOT NULL,
  event bigint NOT NULL,
  verdict text COLLATE "C" NOT NULL,
  bin text COLLATE "C",
  reasons text NOT NULL,
  PRIMARY KEY (part_id, event)
);
COMMENT ON TABLE relayrig.part_rejudged IS 'Changes of part_change that are about verdict, bin or reasons; a trigger fills it';

CREATE FUNCTION relayrig.note_rejudged() RETURNS trigger
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
BEGIN
  INSERT INTO relayrig.part_rejudged (part_id, event, verdict, bin, reasons)
    SELECT part.id, later.event, later.verdict, later.bin, later.reasons FROM later JOIN relayrig.part
      ON part.id = later.part_id AND part.judged_at_us = later.judged_at_us
    WHERE (part.verdict, part.bin, part.reasons) IS DISTINCT FROM (later.verdict, later.bin, later.reasons)
      OR EXISTS (SELECT 1 FROM relayrig.part_rejudged AS before WHERE before.part_id = part.id)
  ON CONFLICT DO NOTHING;
  RETURN NULL;
END $$;
COMMENT ON FUNCTION relayrig.note_rejudged IS 'Fills part_rejudged';

CREATE TRIGGER part_change_rejudges AFTER INSERT ON relayrig.part_change
  REFERENCING NEW TABLE AS later FOR EACH STATEMENT EXECUTE FUNCTION relayrig.note_rejudged();

INSERT INTO relayrig.part_rejudged (part_id, event, verdict, bin, reasons)
  SELECT part.id, later.event, later.verdict, later.bin, later.reasons FROM relayrig.part_change AS later
    JOIN relayrig.part ON part.id = later.part_id AND part.judged_at_us = later.judged_at_us
  WHERE (part.verdict, part.bin, part.reasons) IS DISTINCT FROM (later.verdict, later.bin, later.reasons);
