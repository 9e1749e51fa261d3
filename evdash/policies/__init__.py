"""Ways to decide: each a function from what is known now to a plan.

The paper's own, `p1`, lives in `evdash.scheduling`; what else a policy knows it is given when made.
"""
