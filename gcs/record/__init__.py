"""What a flight leaves behind: records, summary, pictures."""
