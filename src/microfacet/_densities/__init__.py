"""What a density of one's own may come from: samples, tables, histograms, fits; and how it is written down.

`curve.py` is a density between points; `estimate.py` finds one from counts, `tables.py` from what was
measured; `constructors.py` gives `RadialNDF` its other ways to be made, `documents.py` what is saved of it.
"""
