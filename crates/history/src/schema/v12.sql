-- Schema 12: code and arguments of a refusal, so that the audit is read in every language. ordered.refused keeps the English text.

ALTER TABLE ordered ADD COLUMN refusal TEXT -- JSON object with code and args; null for an accepted order, and in rows of before
  CHECK (refusal IS NULL OR json_valid(refusal));
