-- Schema 13: code and arguments of the alarm behind a hold and behind a failed reference check, so that both are read in every
-- language. lot_state.why and golden_check.text keep the English text.

ALTER TABLE lot_state ADD COLUMN alarm TEXT -- JSON object with code and args; null unless an alarm holds the lot, and in rows of before
  CHECK (alarm IS NULL OR json_valid(alarm));
ALTER TABLE golden_check ADD COLUMN alarm TEXT -- JSON object with code and args; null for a passed check, and in rows of before
  CHECK (alarm IS NULL OR json_valid(alarm));
