//! Scores of retrieval: precision-recall, measures, significance, and the report.
