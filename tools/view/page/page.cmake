# kerf_page(OUTPUT PAGE "STYLES" "SCRIPTS"): a page as one text, with its styles, its scripts and three.js in it.
# kerf_live_page(OUTPUT TRANSPORT): that of kerf-live, whose messages the script TRANSPORT sends and receives.
set(view_page_parts ${CMAKE_CURRENT_LIST_DIR})
get_filename_component(live_page_parts ${CMAKE_CURRENT_LIST_DIR}/../../live/page ABSOLUTE)

function(kerf_page output page styles scripts)
  list(JOIN styles "," style_list)
  list(JOIN scripts "," script_list)
  add_custom_command(OUTPUT ${output} DEPENDS ${page} ${styles} ${scripts} ${view_page_parts}/licence.html
      ${view_page_parts}/assemble.cmake ${KERF_THREE_JS}
    COMMAND ${CMAKE_COMMAND} -DPAGE=${page} -DSTYLES=${style_list} -DSCRIPTS=${script_list} -DTHREE=${KERF_THREE_JS}
      -DOUTPUT=${output} -P ${view_page_parts}/assemble.cmake VERBATIM)
endfunction()

function(kerf_live_page output transport)
  set(scripts ${live_page_parts}/state.js)
  foreach(name stage camera normals spots lines)
    list(APPEND scripts ${view_page_parts}/${name}.js)
  endforeach()
  list(APPEND scripts ${live_page_parts}/wire.js ${transport})
  foreach(name solids depth material paint wounds surface world stroke lasso clamp follow cursor pointer files gallery glb record plots controls)
    list(APPEND scripts ${live_page_parts}/${name}.js)
  endforeach()
  kerf_page(${output} ${live_page_parts}/page.html "${view_page_parts}/style.css;${live_page_parts}/live.css" "${scripts}")
endfunction()
