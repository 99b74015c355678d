"""What couples the blocks of a pair, K_ij, from where it is known.

Either blocks (q, 6, 6), K_ij with i < j, or contact springs: the first contact of each pair
(q + 1,), the blocks of the vertices (m,), levers (contact/jacobian.py) and stiffnesses (m,) against
opening and slip.  From springs K_ij is found where it is wanted, in the order and the precision in
which it is wanted: to read six numbers a contact is less than to write 36 and to read them again.
"""

from __future__ import annotations

from clast.compute.jit import overload, types
from clast.compute.vec6 import line, put_line, zeros
from clast.contact.jacobian import couple


def put_coupling(couplings, source, i, target, t):
    """Write K_ij as the pair ``source`` has it into block t of ``target``, i being the row.

    ``source`` is the number of the pair, or minus that minus one where i is its second block.
    """


@overload(put_coupling)
def _put_coupling(couplings, source, i, target, t):
    def of_blocks(couplings, source, i, target, t):
        if source >= 0:
            for a in range(6):
                put_line(target, t, a, line(couplings, source, a))
        else:
            for a in range(6):
                for c in range(6):
                    target[t, c, a] = couplings[-1 - source, a, c]

    def of_springs(couplings, source, i, target, t):
        start, vertex_block, levers, kn, ks = couplings
        q = source if source >= 0 else -1 - source
        for a in range(6):
            put_line(target, t, a, zeros())
        couple(levers, i, t, start[q], start[q + 1], vertex_block, kn, ks, target)

    if isinstance(couplings, types.Array):
        return of_blocks
    return of_springs if isinstance(couplings, types.BaseTuple) else None
