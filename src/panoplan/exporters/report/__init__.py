"""The report: one page that holds all it shows. Its script is built from web/."""
