"""Tests that on two and three ranks of MPI, pieces under vtkMPIController have the bits of the whole mesh, at seams
too."""

import os
import subprocess
import sys
import unittest

RANKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "ranks.py")


class RanksTest(unittest.TestCase):
    def run_ranks(self, count, way):
        command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(count), sys.executable, RANKS, way]
        run = subprocess.run(command, capture_output=True, text=True, timeout=120)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        for rank in range(count):
            self.assertRegex(run.stdout, f"rank {rank} of {count}: [0-9]+ points, 0 normals with other bits")
        return run.stdout

    def test_pieces_that_one_rank_reads_and_sends_have_the_bits_of_the_whole(self):
        for count in (2, 3):
            self.assertEqual(self.run_ranks(count, "transmit").count("read nothing"), count - 1)

    def test_pieces_that_every_rank_takes_have_the_bits_of_the_whole(self):
        for count in (2, 3):
            self.assertEqual(self.run_ranks(count, "extract").count("read all"), count)


if __name__ == "__main__":
    unittest.main()
