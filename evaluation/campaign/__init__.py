"""The tables of docs/integrity.md, from what `bevloc campaign` writes (script/campaign)."""
