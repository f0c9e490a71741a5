// The gradient at the nodes and the assembled matrix, neither of which waits for the other, in one launch.
#include "solve/assemble_block.cl"
#include "solve/gather_two.cl"

// n: 64 for each 64 nodes, then the blocks on and above the diagonal;  the rest as of gather_two_lists (solve/nodes.cl)
// and assemble_blocks (solve/block_matrix.cl)
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void gather_and_assemble(
    const uint n, const uint n_nodes, global const uint* restrict first_offset, global const uint* restrict first_row,
    global const real* restrict first_weight, global const uint* restrict second_offset,
    global const uint* restrict second_row, global const real* restrict second_weight,
    global const uint* restrict is_fixed, global const real* restrict rows, global real* restrict node,
    global real* restrict dx, global real* restrict residual, global const uint* restrict place,
    global const uint* restrict part_first, global const uint* restrict source, global const real* restrict weight,
    global const real* restrict element_blocks, global real* restrict blocks) {
  local LongLists long_lists;
  const uint n_node_items = (n_nodes + ITEMS - 1) / ITEMS * ITEMS;
  const RowLists lists = {first_offset, first_row, first_weight, rows};
  const RowLists second = {second_offset, second_row, second_weight, rows};
  if (get_group_id(0) * ITEMS < n_node_items) {
    gather_two_of_group(n_nodes, &lists, &second, is_fixed, node, dx, residual, &long_lists);
  } else if (get_global_id(0) < n) {
    assemble_block(get_global_id(0) - n_node_items, place, part_first, source, weight, element_blocks, blocks);
  }
}
