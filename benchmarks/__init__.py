"""Cost, robustness and the paper's studies: programs that are no part of the package.

python -m benchmarks.bench        what scenes of any size cost, by stage: ``make bench``
python -m benchmarks.peers        clast beside Chipmunk and Box2D: ``make performance``
python -m benchmarks.paper        the paper's studies: ``make paper``
python -m benchmarks.robustness   walls and heaps over stiffness and step
"""
