"""How each kind of agent learns in a study, and what its learning costs."""
