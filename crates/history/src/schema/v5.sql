-- Schema 5: the values of a part side by side. A row of measurement is mostly its budget, so that the values
-- of two parts fill a page; here those of fourteen do, and a list of parts is read from a tenth of the pages.

CREATE INDEX measurement_part ON measurement (part_id, parameter_id, attempt, value, uncertainty);
