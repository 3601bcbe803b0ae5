-- Schema 9: the arguments of an alarm's text, so that it is said in every language. alarm.text keeps the English text.

ALTER TABLE alarm ADD COLUMN args TEXT    -- JSON object of texts by name; null in rows of before
  CHECK (args IS NULL OR json_valid(args));
